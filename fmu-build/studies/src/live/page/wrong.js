// A text without a motion: the last valid motion is shown in grey, below the drawing of the text.

/** Data with the last valid motion and the present faults. */
function overGood(data, last) {
  const { error, findings, still, scene } = data;
  return { ...last, error, findings, still: still ?? undefined, wrong: still && { scene, poses: still.poses } };
}

/** Draw the bodies at the positions of the text. */
function drawWrong(drawing, { scene, poses }) {
  for (const body of scene.bodies) {
    if (body.points[0].frame === 0) continue;
    const corners = hull(body.points.map((point) => drawing.at(place(poses, point))));
    if (corners.length > 1) element("path", { class: "wrong", d: line(corners) + (corners.length > 2 ? "Z" : "") }, drawing.layers.gaps);
  }
}
