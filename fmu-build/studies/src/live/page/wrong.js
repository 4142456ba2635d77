// A text that gives no motion: the last good motion stays, greyed, under what the text gives.

/** Data with the last good motion and what is wrong now. */
function overGood(data, last) {
  const { error, findings, still, scene } = data;
  return { ...last, error, findings, still: still ?? undefined, wrong: still && { scene, poses: still.poses } };
}

/** Draw the bodies where the text puts them. */
function drawWrong(drawing, { scene, poses }) {
  for (const body of scene.bodies) {
    if (body.points[0].frame === 0) continue;
    const corners = hull(body.points.map((point) => drawing.at(place(poses, point))));
    if (corners.length > 1) element("path", { class: "wrong", d: line(corners) + (corners.length > 2 ? "Z" : "") }, drawing.layers.gaps);
  }
}
