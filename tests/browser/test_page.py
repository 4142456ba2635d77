"""Content and behaviour of a page, against the numbers of the engine and closed forms."""

from __future__ import annotations

import math
import re
from copy import deepcopy

import pytest
from conftest import Make, Mechanism, Show, Shown, definition, inaccessible, until

GEAR = definition("LandingGearRetraction")
#: Distance of the gear's ground pins [m].
BASE = GEAR["bodies"]["ground"]["length"]


def broken() -> Mechanism:
    """The gear with a coupler that is too short."""
    mechanism = deepcopy(GEAR)
    mechanism["bodies"]["coupler"]["length"] = 0.02
    return mechanism


def seek(shown: Shown, index: float) -> None:
    shown.page.evaluate("(index) => mechanism.seek(index)", index)


def number(text: str) -> float:
    return float(text.replace("\N{MINUS SIGN}", "-").replace("\N{NARROW NO-BREAK SPACE}", ""))


def gear_points(shown: Shown, index: int) -> dict[str, tuple[float, float]]:
    """Points of the gear [m] from the angles and the marker of the engine, and the lengths of the definition."""
    crank, follower = (shown.values(f"{body}.angle")[index] for body in ("crank", "follower"))
    lengths = {body: GEAR["bodies"][body]["length"] for body in ("crank", "follower")}
    return {
        "[data-joint=joint2]": (lengths["crank"] * math.cos(crank), lengths["crank"] * math.sin(crank)),
        "[data-joint=joint3]": (
            BASE + lengths["follower"] * math.cos(follower),
            lengths["follower"] * math.sin(follower),
        ),
        "[data-marker=wheel]": (shown.values("wheel.x")[index], shown.values("wheel.y")[index]),
    }


@pytest.mark.parametrize("name", ["LandingGearRetraction", "SliderCrank", "FourBar", "Jib", "CraneJib", "SlCrank"])
def test_a_page_loads_without_errors_or_requests(name: str, make: Make, show: Show) -> None:
    made = make(definition(name))
    assert made.code == 0, made.output
    shown = show(made.path)
    assert shown.page.title() == name
    assert shown.page.locator("#drawing .body").count() >= 1
    assert shown.page.locator("figure.plot canvas").count() >= 1
    assert not shown.page.locator("#error").is_visible()


@pytest.mark.parametrize("index", [0, 77, 150, 299])
def test_drawn_points_are_the_engines_to_a_pixel(index: int, make: Make, show: Show) -> None:
    shown = show(make(GEAR).path)
    seek(shown, index)
    # The ground pins give the scale.
    (x1, y1), (x4, y4) = shown.center("[data-joint=joint1]"), shown.center("[data-joint=joint4]")
    scale = (x4 - x1) / BASE
    assert scale > 200
    assert abs(y1 - y4) < 0.5
    for selector, (x, y) in gear_points(shown, index).items():
        drawn = shown.center(selector)
        expected = (x1 + scale * x, y1 - scale * y)
        assert math.dist(drawn, expected) < 1.0, selector


def test_between_two_frames_joints_stay_closed(make: Make, show: Show) -> None:
    shown = show(make(definition("SliderCrank")).path)
    for index in (10.5, 133.3, 200.7):
        seek(shown, index)
        gaps = shown.page.evaluate(
            """() => mechanism.data.scene.joints.filter((j) => !j.axis).map(({ first, second }) => {
              const point = ({ frame, at: [x, y] }) => {
                const [angle, x0, y0] = mechanism.drawing.poses[frame];
                return [x0 + x * Math.cos(angle) - y * Math.sin(angle), y0 + x * Math.sin(angle) + y * Math.cos(angle)];
              };
              const [a, b] = [point(first), point(second)];
              return mechanism.drawing.scale * Math.hypot(a[0] - b[0], a[1] - b[1]);
            })"""
        )
        assert max(gaps) < 0.5


def test_it_plays_pauses_and_repeats(make: Make, show: Show) -> None:
    shown = show(make(GEAR).path)
    page = shown.page
    page.get_by_role("button", name="Play").click()
    until(shown, "mechanism.clock.index > 5")
    assert page.get_by_role("button", name="Pause").get_attribute("aria-pressed") == "true"
    before = page.locator("[data-joint=joint3]").get_attribute("transform")
    until(shown, f"mechanism.clock.index > {page.evaluate('mechanism.clock.index') + 5}")
    assert page.locator("[data-joint=joint3]").get_attribute("transform") != before
    page.locator("#drawing").click()
    page.keyboard.press("Space")
    stopped = page.evaluate("mechanism.clock.index")
    page.wait_for_timeout(150)
    assert page.evaluate("mechanism.clock.index") == stopped
    # At the end the animation starts again, unless repetition is off.
    page.get_by_label("Speed relative to real time").select_option("1")
    page.evaluate("mechanism.seek(295)")
    page.get_by_role("button", name="Play").click()
    until(shown, "mechanism.clock.index < 290")
    page.get_by_role("button", name="Repeat").click()
    until(shown, "!mechanism.clock.isPlaying")
    assert page.evaluate("mechanism.clock.index === mechanism.clock.last")


def test_keys_and_sliders_move_the_time(make: Make, show: Show) -> None:
    page = show(make(GEAR).path).page
    page.locator("#drawing").click()
    for key, index in [("ArrowRight", 1), ("Shift+ArrowRight", 11), ("ArrowLeft", 10), ("End", 300), ("Home", 0)]:
        page.keyboard.press(key)
        assert page.evaluate("mechanism.clock.index") == index, key
    assert page.locator("#time-text").inner_text() == "0.0000 s"
    slider = page.get_by_label("Time", exact=True)
    slider.focus()
    page.keyboard.press("PageUp")
    assert page.evaluate("mechanism.clock.index") == 10
    slider.fill("150")
    assert page.locator("#time-text").inner_text() == "0.0750 s"
    assert slider.get_attribute("aria-valuetext") == "0.0750 s"


def test_the_plots_cursor_agrees_with_the_table(make: Make, show: Show) -> None:
    shown = show(make(GEAR).path)
    page = shown.page
    ends = page.evaluate("[0, mechanism.clock.last * mechanism.clock.step]")
    heights: list[tuple[float, float]] = []
    for index in (0, 60, 210.5, 300):
        seek(shown, index)
        assert page.locator("b[data-value='crank.angle']").inner_text() == shown.cell("crank.angle", 1)
        assert page.locator("b[data-value='joint1.force']").inner_text() == shown.cell("joint1.force")
        samples = shown.values("crank.angle")
        low = math.floor(index)
        exact = samples[low] + (index - low) * (samples[min(low + 1, 300)] - samples[low])
        assert number(shown.cell("crank.angle")) == pytest.approx(exact, rel=1e-4, abs=1e-6)
        assert number(shown.cell("crank.angle", 1)) == pytest.approx(math.degrees(exact), rel=1e-4, abs=1e-4)
        # The cursor is at the present time and its dot at the value. Both are linear functions of the position in the
        # plot.
        over = page.locator("figure[data-unit=deg] .u-over").bounding_box()
        dot = page.locator("[data-dot='crank.angle']").bounding_box()
        assert over is not None
        assert dot is not None
        present = index * ends[1] / 300
        x = dot["x"] + dot["width"] / 2 - over["x"]
        assert abs(x - over["width"] * present / ends[1]) < 1.0
        assert abs(shown.center("figure[data-unit=deg] .now")[0] - over["x"] - x) < 1.0
        heights.append((exact, dot["y"] + dot["height"] / 2))
    (value0, y0), (value1, y1) = heights[0], heights[-1]
    assert y1 - y0 > 50
    for value, y in heights[1:-1]:
        assert abs(y0 + (y1 - y0) * (value - value0) / (value1 - value0) - y) < 1.0


def test_a_tick_in_the_table_plots_a_variable(make: Make, show: Show) -> None:
    page = show(make(GEAR).path).page
    page.get_by_label("Filter variables by name").fill("energy")
    page.get_by_label("Plot energy.kinetic").check()
    assert page.locator("figure[data-unit=J] b[data-value='energy.kinetic']").count() == 1
    page.get_by_label("Plot energy.kinetic").uncheck()
    assert page.locator("figure[data-unit=J]").count() == 0
    page.get_by_label("Filter variables by name").fill("")
    page.get_by_role("button", name="Parameters").click()
    assert page.locator("tr[data-variable='crank.length'] td.number span").first.inner_text() == "0.17550"


def test_the_travel_goes_from_stop_to_stop(make: Make, show: Show) -> None:
    shown = show(make(GEAR).path)
    page = shown.page
    page.get_by_label("Position of the mechanism along the travel, independent of time").focus()
    angles = []
    for key in ("Home", "End"):
        page.keyboard.press(key)
        angles.append(number(shown.cell("crank.angle")))
        (x1, y1), (x2, y2) = shown.center("[data-joint=joint1]"), shown.center("[data-joint=joint2]")
        assert math.atan2(y1 - y2, x2 - x1) == pytest.approx(angles[-1], abs=0.01)
    assert sorted(angles) == pytest.approx([-1.3, 0.8], abs=1e-5)
    assert number(shown.cell("crank.angle", 1)) == pytest.approx(math.degrees(angles[-1]), abs=1e-2)
    page.keyboard.press("Space")
    until(shown, "mechanism.clock.index > 0")


def length_of(shown: Shown, name: str) -> float:
    """Length of a drawn arrow [px], from its first point to its tip."""
    path = shown.page.locator(f"[data-arrow='{name}'].reaction path").first.get_attribute("d") or ""
    points = [tuple(map(float, pair)) for pair in re.findall(r"(-?[\d.]+) (-?[\d.]+)", path)]
    return math.dist(points[0], points[3])


def test_a_peak_of_a_force_stays_in_the_drawing_and_ends_of_cylinders_have_names(make: Make, show: Show) -> None:
    page = show(make(definition("LiftArm")).path).page
    assert [page.locator(f"#travel-{end}").inner_text() for end in ("low", "high")] == ["guy.extended", "lift.extended"]
    assert "lift.extended" in page.locator("#hint").inner_text()
    assert page.locator(".arrow.load.cut").count() == 2
    room = page.locator("#drawing").bounding_box()
    assert room
    for arrow in page.locator(".arrow.load path").all():
        box = arrow.bounding_box()
        assert box
        assert room["x"] <= box["x"] <= box["x"] + box["width"] <= room["x"] + room["width"]
        assert room["y"] <= box["y"] <= box["y"] + box["height"] <= room["y"] + room["height"]


def test_reactions_are_arrows_to_scale_that_can_be_switched(make: Make, show: Show) -> None:
    shown = show(make(GEAR).path)
    assert not shown.page.locator(".arrow.reaction").first.is_visible()
    shown.page.get_by_role("button", name="Reactions").click()
    assert shown.page.locator(".arrow.reaction[data-arrow=joint1]").first.is_visible()
    scales = []
    for index in (30, 180, 290):
        seek(shown, index)
        scales += [length_of(shown, joint) / shown.values(f"{joint}.force")[index] for joint in ("joint1", "joint4")]
    assert max(scales) == pytest.approx(min(scales), rel=0.01)
    # The arrow in the legend has the same scale.
    words = shown.page.locator(".key text").text_content()
    key = shown.page.evaluate("document.querySelector('.key path').getBBox().width")
    assert words == "50 kN"
    assert key / 50e3 == pytest.approx(scales[0], rel=0.01)


def test_a_broken_mechanism_is_drawn_at_its_guess_with_the_gap(make: Make, show: Show) -> None:
    made = make(broken())
    assert made.code == 1
    assert str(made.path) in made.output
    assert "the loop of joint4 cannot close" in made.output
    shown = show(made.path)
    assert shown.page.get_by_role("alert").is_visible()
    assert "the positions of the guess" in shown.page.get_by_role("alert").inner_text()
    words = shown.page.locator("[data-gap=joint4] text").text_content() or ""
    gap = float(words.split()[-3])
    # The two pins of the crank give the scale.
    scale = math.dist(shown.center("[data-joint=joint1]"), shown.center("[data-joint=joint2]")) / 0.1755
    circles = shown.page.locator("[data-gap=joint4] circle")
    ends = [[float(circles.nth(k).get_attribute(axis) or "nan") for axis in ("cx", "cy")] for k in (0, 1)]
    assert math.dist(*ends) == pytest.approx(scale * gap, abs=1.0)
    links = [(0.1755, 0.8), (0.02, 0.46), (-0.34, 2.43)]
    reached = [sum(length * trigonometry(angle) for length, angle in links) for trigonometry in (math.cos, math.sin)]
    assert gap == pytest.approx(math.dist(reached, (BASE, 0.0)), rel=1e-3)


def test_names_do_not_collide_and_all_have_room(make: Make, show: Show) -> None:
    page = show(make(definition("MainGear")).path).page
    collisions = """() => {
      const boxes = [...document.querySelectorAll("#drawing text")].filter((text) => text.checkVisibility());
      const found = boxes.map((text) => [text.textContent, text.getBoundingClientRect()]);
      return found.flatMap(([name, a], k) => found.slice(k + 1).filter(([, b]) =>
        Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 &&
        Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 4).map(([other]) => [name, other]));
    }"""
    for index in (0, 90, 180, 300):
        page.evaluate("(index) => mechanism.seek(index)", index)
        assert page.evaluate(collisions) == [], index
        assert page.locator("#drawing .name:visible").count() >= 20


def test_the_drawing_can_be_zoomed_moved_and_reset(make: Make, show: Show) -> None:
    shown = show(make(GEAR).path)
    page = shown.page
    before = shown.center("[data-joint=joint3]")
    page.mouse.move(*before)
    page.mouse.wheel(0, -400)
    until(shown, "mechanism.page.view.zoom > 1.5")
    page.wait_for_timeout(60)
    # The point under the pointer stays in place.
    assert math.dist(shown.center("[data-joint=joint3]"), before) < 1.5
    page.mouse.down()
    page.mouse.move(before[0] + 60, before[1] + 30)
    page.mouse.up()
    page.wait_for_timeout(60)
    assert math.dist(shown.center("[data-joint=joint3]"), (before[0] + 60, before[1] + 30)) < 1.5
    page.keyboard.press("0")
    page.wait_for_timeout(60)
    assert math.dist(shown.center("[data-joint=joint3]"), before) < 0.1


def test_the_ends_of_the_travel_have_the_names_of_stops_in_the_direction_of_motion(make: Make, show: Show) -> None:
    shown = show(make(GEAR).path)
    page = shown.page
    assert [page.locator(f"#travel-{end}").inner_text() for end in ("low", "high")] == ["downstop", "upstop"]
    page.get_by_label("Position of the mechanism along the travel, independent of time").focus()
    page.keyboard.press("End")
    assert number(shown.cell("crank.angle")) == pytest.approx(-1.3, abs=1e-5)


def test_plots_over_a_variable_and_over_the_travel(make: Make, show: Show) -> None:
    shown = show(make(GEAR).path)
    page = shown.page
    assert page.locator("b[data-value='actuator.force']").count() == 1
    assert page.locator("b[data-value='upstop.torque']").count() == 1
    seek(shown, 120)
    page.get_by_label("Plots over").select_option("motion:actuator.length")
    page.wait_for_timeout(30)
    lengths = shown.values("actuator.length")
    over = page.locator("figure[data-unit=N] .u-over").bounding_box()
    assert over is not None
    part = (shown.center("figure[data-unit=N] .now")[0] - over["x"]) / over["width"]
    assert part == pytest.approx((lengths[120] - min(lengths)) / (max(lengths) - min(lengths)), abs=0.01)
    page.get_by_label("Plots over").select_option("travel:crank.angle")
    assert page.evaluate("mechanism.page.mode") == "travel"
    assert page.locator("b[data-value='actuator.holding_force']").inner_text() == shown.cell("actuator.holding_force")
    # At its stop the gear has the holding force that `check` prints.
    page.evaluate("mechanism.travelTo(mechanism.data.travel.start)")
    assert number(shown.cell("actuator.holding_force")) == pytest.approx(-2721.8, abs=0.1)
    # Virtual work: crank torque per unit of force equals length per unit of angle.
    ratio = number(shown.cell("actuator.advantage_on_crank"))
    page.evaluate("mechanism.travelTo(mechanism.data.travel.start - 1e-3)")
    change = [number(shown.cell(name)) for name in ("actuator.length", "crank.angle")]
    page.evaluate("mechanism.travelTo(mechanism.data.travel.start)")
    change = [a - number(shown.cell(name)) for a, name in zip(change, ("actuator.length", "crank.angle"), strict=True)]
    assert change[0] / change[1] == pytest.approx(ratio, rel=0.03)


def test_key_results_lead_to_their_positions(make: Make, show: Show) -> None:
    shown = show(make(GEAR).path)
    rows = dict(row.split("\t")[:2] for row in shown.page.locator("#results table").inner_text().splitlines())
    assert rows["Stroke of actuator"].startswith("0.3182")
    assert number(rows["Time to the stop upstop"].rstrip("s")) == pytest.approx(0.1321, abs=2e-4)
    force = shown.values("joint1.force")
    assert number(rows["Largest reaction, in joint1"].rstrip("N")) == pytest.approx(max(force), rel=1e-3)
    # 30 kN over the stroke.
    assert number(rows["Work of actuator"].rstrip("J")) == pytest.approx(30e3 * 0.31819, rel=1e-3)
    shown.page.locator("#results tr", has_text="Largest reaction").get_by_role("button").click()
    assert shown.page.evaluate("mechanism.clock.index") == force.index(max(force))


def test_the_drawing_the_plots_and_the_values_are_saved(make: Make, show: Show) -> None:
    page = show(make(GEAR).path).page
    begins = {"svg": b"<svg", "png": b"\x89PNG", "plots-svg": b"<svg", "plots-png": b"\x89PNG", "csv": b'"time [s]"'}
    for kind, begin in begins.items():
        page.get_by_label("Save or copy").click()
        with page.expect_download() as download:
            page.locator(f"[data-save={kind}]").click()
        content = download.value.path().read_bytes()
        assert content.startswith(begin), kind
        assert len(content) > 5000, kind
        if kind == "csv":
            assert content.count(b"\n") == 302
        if kind == "svg":
            assert b"var(--" not in content
            assert b"color-mix" not in content


def test_two_runs_are_compared(make: Make, show: Show) -> None:
    shown = show(make(GEAR, "--compare-set", "actuator.force", "2e4").path)
    page = shown.page
    assert page.locator("#compared").inner_text() == "solid: as defined · dashed: actuator.force 2e4"
    seek(shown, 200)
    # Each ghost is at the position of the body in the other run.
    angles = page.evaluate(
        """() => [mechanism.data, mechanism.data.compare].map(({ motion }) =>
          motion.variables.find((v) => v.name === "crank.angle").samples[200])"""
    )
    for selector, angle in zip(("[data-body=crank]", "[data-compared=crank]"), angles, strict=True):
        turned = re.search(r"rotate\((.*?)\)", page.locator(selector).first.get_attribute("transform") or "")
        assert turned is not None
        assert -float(turned[1]) == pytest.approx(math.degrees(angle), abs=0.02)
    assert abs(angles[0] - angles[1]) > 0.2
    row = page.locator("#results tr", has_text="Largest force of actuator").inner_text().split("\t")
    assert [number(cell.rstrip("N")) for cell in row[1:3]] == [3e4, 2e4]


def test_markup_in_texts_is_shown_as_text(make: Make, show: Show) -> None:
    mechanism = deepcopy(GEAR)
    markup = "</script><img src=x onerror=alert(1)> \"quotes\" '&amp;' \u202ereversed\u202c {{ 7*7 }}"
    mechanism["description"] = markup
    shown = show(make(mechanism).path)
    assert shown.page.locator(".lead").text_content() == markup
    assert shown.page.locator("img").count() == 0
    assert shown.data()["description"] == markup


def test_a_phone_shows_all_in_its_width(make: Make, show: Show) -> None:
    for mechanism in (GEAR, broken()):
        page = show(make(mechanism).path, width=360, height=740).page
        assert page.evaluate("document.scrollingElement.scrollWidth") <= 360
        for button in page.get_by_role("button").all():
            box = button.bounding_box()
            assert box is None or (box["x"] >= 0 and box["x"] + box["width"] <= 360)


def test_dark_and_light_follow_the_system_and_the_switch(make: Make, show: Show) -> None:
    background = "getComputedStyle(document.body).backgroundColor"
    light = show(make(GEAR).path).page
    dark = show(make(GEAR).path, scheme="dark").page
    assert light.evaluate(background) != dark.evaluate(background)
    dark.get_by_label("Switch between dark and light").click()
    assert light.evaluate(background) == dark.evaluate(background)


def test_every_control_has_a_name(make: Make, show: Show) -> None:
    page = show(make(GEAR).path).page
    tree = page.locator("body").aria_snapshot()
    for role in ("button", "slider", "checkbox", "combobox", "searchbox", "img"):
        found = re.findall(rf"- {role}(.*)", tree)
        assert found, role
        assert all(re.match(r' "[^"]+', name) or re.match(r" '", name) for name in found), (role, found)


def test_a_print_has_the_drawing_and_no_controls(make: Make, show: Show) -> None:
    page = show(make(GEAR).path, scheme="dark").page
    page.emulate_media(media="print")
    assert page.locator("#drawing").is_visible()
    assert page.locator("#values").is_visible()
    assert not page.locator("#controls").is_visible()
    assert not page.locator("#layers").is_visible()
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"


def test_start_values_and_stop_time_are_taken(make: Make, show: Show) -> None:
    options = ("--stop-time", "0.05", "--start-values", "crank.start_angle", "30deg", "actuator.force", "2e4")
    shown = show(make(GEAR, *options).path)
    assert shown.values("crank.angle")[0] == pytest.approx(math.radians(30), abs=1e-6)
    assert shown.values("actuator.force")[0] == 2e4
    assert shown.page.evaluate("mechanism.clock.last * mechanism.clock.step") == pytest.approx(0.05)


@pytest.mark.parametrize(("scheme", "width"), [("light", 1400), ("dark", 390)])
@pytest.mark.parametrize("mechanism", [GEAR, broken()], ids=["motion", "gap"])
def test_axe_finds_nothing_serious(mechanism: Mechanism, scheme: str, width: int, make: Make, show: Show) -> None:
    assert inaccessible(show(make(mechanism).path, width=width, scheme=scheme)) == []
