"""The page of `cargo fmu view --live`: the server, the editor, handles and sliders."""

from __future__ import annotations

import http.client
import json
import os
import re
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from conftest import REPOSITORY, Shown, inaccessible, until
from playwright.sync_api import Browser

GEAR = (REPOSITORY / "modelDescription/LandingGearRetraction/resources/mechanism.json").read_text(encoding="utf-8")
#: A drawn slider-crank in mm.
DRAWN = re.search(
    r"## Example\n```json\n(.*?)```", (REPOSITORY / "docs/reference/mechanism/drawn.md").read_text("utf-8"), re.DOTALL
)
EDITOR = "mechanism.live.editor"


@dataclass
class Live:
    """A server with the pages that show its file."""

    file: Path
    url: str
    browser: Browser
    pages: list[Shown] = field(default_factory=list)

    def open(self, width: int = 1500, height: int = 900, scheme: str = "light") -> Shown:
        context = self.browser.new_context(
            viewport={"width": width, "height": height}, color_scheme="dark" if scheme == "dark" else "light"
        )
        shown = Shown(context.new_page())
        page = shown.page
        page.on("console", lambda message: shown.hear(message.type, message.text))
        page.on("pageerror", lambda error: shown.problems.append(f"error: {error}"))
        page.on("request", lambda request: shown.requests.append(request.url))
        page.goto(self.url)
        page.wait_for_selector("body[data-ready]")
        self.pages.append(shown)
        return shown


Serve = Callable[..., Live]


@pytest.fixture
def serve(browser: Browser, tmp_path: Path) -> Iterator[Serve]:
    """Serves a text as a file. Each page must have had no problem and no request to another server."""
    program = os.environ.get("LINKAGE_VIEW")
    assert program, "LINKAGE_VIEW names no program; run the tests by `cargo fmu test`"
    started: list[tuple[subprocess.Popen[str], Live]] = []

    def start(text: str, name: str = "a gear.json") -> Live:
        file = tmp_path / name
        file.write_bytes(text.encode())
        process = subprocess.Popen([program, "view", str(file), "--live"], stdout=subprocess.PIPE, text=True)
        assert process.stdout is not None
        live = Live(file, process.stdout.readline().split()[0], browser)
        started.append((process, live))
        return live

    yield start
    for process, live in started:
        for shown in live.pages:
            shown.page.context.close()
            assert shown.problems == []
            assert [url for url in shown.requests if not url.startswith((live.url, "data:"))] == []
        process.terminate()
        assert process.wait(10) != 0
        assert process.stdout is not None
        process.stdout.close()


def text_of(shown: Shown) -> str:
    return shown.page.evaluate(f"{EDITOR}.text")


def edit(shown: Shown, before: str, after: str) -> None:
    """Replace a text by another text in the editor, as a user does."""
    place = shown.page.evaluate(f"(before) => {EDITOR}.text.indexOf(before)", before)
    assert place >= 0, before
    shown.page.evaluate(f"([from, to]) => {EDITOR}.goTo(from, to)", [place, place + len(before)])
    shown.page.keyboard.insert_text(after)


def settled(shown: Shown) -> None:
    """Wait until the page shows the text of the editor."""
    until(shown, f"mechanism.live.runs.last.text === {EDITOR}.text && !mechanism.live.runs.isOut")


def drag(shown: Shown, handle: str, x: float, y: float) -> None:
    """Drag a handle by this number of pixels."""
    a, b = shown.center(f'[data-handle="{handle}"] .ring')
    mouse = shown.page.mouse
    mouse.move(a, b)
    mouse.down()
    mouse.move(a + x / 2, b + y / 2)
    mouse.move(a + x, b + y)
    mouse.up()
    settled(shown)


def test_a_save_outside_is_shown(serve: Serve) -> None:
    live = serve(GEAR)
    shown = live.open()
    length = "mechanism.data.scene.bodies[1].points.find((p) => p.name === 'end').at[0]"
    assert shown.page.evaluate(length) == 0.1755
    shown.page.evaluate("mechanism.seek(100)")
    live.file.write_text(GEAR.replace("0.1755", "0.1765"), encoding="utf-8")
    until(shown, f"{length} === 0.1765")
    # Some editors write a new file and rename it.
    other = live.file.with_suffix(".new")
    other.write_text(GEAR.replace("0.1755", "0.1745"), encoding="utf-8")
    other.replace(live.file)
    until(shown, f"{length} === 0.1745")
    assert "0.1745" in text_of(shown)
    assert shown.page.evaluate("mechanism.clock.index") == 100
    assert shown.page.locator("#live-state").inner_text() == "Saved"


def test_text_is_edited_checked_and_saved(serve: Serve) -> None:
    live = serve(GEAR.replace("\n", "\r\n"))
    before = live.file.read_bytes()
    shown = live.open()
    page = shown.page
    edit(shown, "30000", "40000")
    settled(shown)
    assert shown.values("actuator.force")[0] == 40000
    assert page.locator("#live-state").inner_text() == "Not saved"
    # The text is no JSON: the place is marked, the motion remains.
    edit(shown, '"shape": "uniform_rod", "axial_stiffness": 2.1e9', '"shape": "rod", "axial_stiffness": 2.1e9')
    settled(shown)
    assert page.locator("body.stale").count() == 1
    assert page.locator(".cm-lintRange-error").inner_text() == '"rod"'
    assert page.locator("#live-findings").inner_text() == "1 error"
    assert page.locator("#error").is_visible()
    page.keyboard.press("Control+z")
    settled(shown)
    assert page.locator("body.stale, .cm-lintRange-error").count() == 0
    # The loops cannot close: the gap is drawn over the last motion.
    edit(shown, "0.217", "0.02")
    settled(shown)
    assert page.locator("body.stale").count() == 1
    assert "apart" in (page.locator("[data-gap] text").first.text_content() or "")
    assert page.locator("path.wrong").count() > 0
    page.get_by_role("button", name="Undo").click()
    settled(shown)
    assert page.locator("body.stale, [data-gap]").count() == 0
    assert live.file.read_bytes() == before
    page.keyboard.press("Control+s")
    until(shown, "document.getElementById('live-state').textContent === 'Saved'")
    assert live.file.read_bytes() == before.replace(b"30000", b"40000")
    # The editor offers the words of the schema.
    edit(shown, '"solver": {', '"solver": { ')
    page.keyboard.type('"prep')
    page.locator(".cm-tooltip-autocomplete").wait_for()
    assert "prepare" in page.locator(".cm-tooltip-autocomplete").inner_text()


def test_points_and_stops_are_dragged(serve: Serve) -> None:
    live = serve(GEAR)
    shown = live.open()
    scale = shown.page.evaluate("mechanism.drawing.scale")
    before = text_of(shown)
    drag(shown, "bodies.follower.points.actuator", 0, 40)
    found = re.search(r'"actuator": \[(-?[\d.]+), (-?[\d.]+)\] }\s+}\s+},\s+"joints"', text_of(shown))
    assert found
    # The axes of the follower turn with the follower. The distance of the point equals that of the pointer.
    moved = [float(found[1]) - 0.020, float(found[2]) - 0.120]
    assert (moved[0] ** 2 + moved[1] ** 2) ** 0.5 == pytest.approx(40 / scale, abs=2e-3)
    assert all(len(number.split(".")[1]) <= 3 for number in found.groups())
    pair = found[0].split("}")[0]
    assert text_of(shown) == before.replace('"actuator": [0.020, 0.120] ', pair)
    at = shown.center('[data-handle="bodies.follower.points.actuator"] .ring')
    # One drag is one step of undo and redo.
    shown.page.get_by_role("button", name="Undo").click()
    settled(shown)
    assert text_of(shown) == before
    shown.page.get_by_role("button", name="Redo").click()
    settled(shown)
    assert shown.center('[data-handle="bodies.follower.points.actuator"] .ring') == pytest.approx(at, abs=1)
    drag(shown, "stops.upstop.angle", 0, 30)
    angle = re.search(r'"limit": "lower", "angle": (-[\d.]+)', text_of(shown))
    assert angle
    assert -1.3 < float(angle[1]) < -1.1 or -1.5 < float(angle[1]) < -1.3
    assert live.file.read_text(encoding="utf-8") == GEAR


def test_a_drawn_joint_moves_both_bodies(serve: Serve) -> None:
    assert DRAWN
    live = serve(DRAWN[1])
    shown = live.open()
    scale = shown.page.evaluate("mechanism.drawing.scale")
    # The motion starts at 30 deg. The drawing has atan(60 / 80).
    drag(shown, "bodies.crank.drawn.points.eye", 25, 0)
    eye = re.search(r'"eye": \[(-?[\d.]+), (-?[\d.]+)\]', text_of(shown))
    assert eye
    moved = [float(eye[1]) - 52, float(eye[2]) - 14]
    assert (moved[0] ** 2 + moved[1] ** 2) ** 0.5 == pytest.approx(25e3 / scale, abs=1.5)
    drag(shown, "bodies.crank.drawn.end", 0, -20)
    ends = re.search(r'"end": (\[.*?\]).*?"origin": (\[.*?\])', text_of(shown), re.DOTALL)
    assert ends
    assert ends[1] == ends[2] != "[80, 60]"
    assert shown.page.locator("body.stale").count() == 0
    assert json.loads(text_of(shown))["units"] == {"angle": "deg", "length": "mm"}


def test_sliders_change_the_run_and_not_the_text(serve: Serve) -> None:
    live = serve(GEAR)
    shown = live.open()
    page = shown.page
    page.get_by_label("actuator.force", exact=True).fill("20000")
    until(shown, "!mechanism.live.runs.isOut && mechanism.live.runs.shown > 1")
    assert shown.values("actuator.force")[0] == 20000
    field_of = page.get_by_label("Add a slider by the name of its variable")
    field_of.fill("crank.start_angle")
    field_of.press("Enter")
    number = page.get_by_label("Value of crank.start_angle")
    assert float(number.input_value()) == pytest.approx(45.8366)
    number.fill("30")
    number.press("Enter")
    until(shown, "mechanism.data.motion.variables.find((v) => v.name === 'crank.angle').samples[0] < 0.53")
    number.fill("9000")
    number.press("Enter")
    until(shown, "document.getElementById('live-knobs-problem').textContent !== '' || document.body.matches('.stale')")
    page.get_by_role("button", name="Values of the text").click()
    until(shown, "mechanism.data.motion.variables.find((v) => v.name === 'actuator.force').samples[0] === 30000")
    assert shown.page.locator("body.stale").count() == 0
    assert text_of(shown) == GEAR
    assert page.locator("#live-state").inner_text() == "Saved"


def test_two_pages_share_the_file(serve: Serve) -> None:
    live = serve(GEAR)
    one, other = live.open(), live.open(420, 800, "dark")
    edit(one, "30000", "31000")
    one.page.get_by_role("button", name="Save").click()
    until(other, f"{EDITOR}.text.includes('31000')")
    settled(other)
    # A text that is not saved is kept until the user has chosen.
    edit(other, "36.8", "36.9")
    edit(one, "31000", "32000")
    one.page.get_by_role("button", name="Save").click()
    other.page.locator("#live-conflict").wait_for()
    assert "31000" in text_of(other)
    other.page.get_by_role("button", name="Keep this text").click()
    other.page.get_by_role("button", name="Save").click()
    until(one, f"{EDITOR}.text.includes('36.9')")
    assert "31000" in live.file.read_text(encoding="utf-8")
    edit(other, "36.9", "40.1")
    live.file.write_text(GEAR, encoding="utf-8")
    other.page.get_by_role("button", name="Load the file").click()
    settled(other)
    assert text_of(other) == GEAR == text_of(one)


def test_a_deleted_file_is_reported_and_can_be_written_again(serve: Serve) -> None:
    live = serve(GEAR)
    shown = live.open()
    live.file.unlink()
    until(shown, "!document.getElementById('live-lost').hidden")
    assert live.file.name in shown.page.locator("#live-lost").inner_text()
    assert text_of(shown) == GEAR
    shown.page.get_by_role("button", name="Save").click()
    until(shown, "document.getElementById('live-state').textContent === 'Saved'")
    assert live.file.read_text(encoding="utf-8") == GEAR
    assert not shown.page.locator("#live-lost").is_visible()


def test_numbers_in_messages_have_few_digits(serve: Serve) -> None:
    shown = serve(GEAR).open()
    edit(shown, '"stop_time": 0.15', '"stop_time": -0.0033333333333333335')
    settled(shown)
    assert re.search(r"-0\.00333333\b", shown.page.locator("#findings").inner_text())


def test_markup_in_texts_stays_text(serve: Serve) -> None:
    evil = "</script><img src=x onerror=alert(1)>"
    live = serve(GEAR.replace("Retraction mechanism of", evil), "a&lt;b'\"<i>.json")
    shown = live.open()
    assert shown.page.locator("#live-file").inner_text() == live.file.name
    edit(shown, '"crank": {', f'"{evil}": {{}}, "crank": {{')
    settled(shown)
    assert evil in shown.page.locator("#findings").inner_text()
    assert shown.page.locator("img").count() == 0


def test_only_the_page_itself_is_served(serve: Serve) -> None:
    live = serve(GEAR)
    address = urlsplit(live.url)
    assert address.hostname == "127.0.0.1"
    assert re.fullmatch(r"/[0-9a-f]{32}/", address.path)

    def status(method: str, path: str, **headers: str) -> int:
        connection = http.client.HTTPConnection("127.0.0.1", address.port, timeout=10)
        body = json.dumps({"text": "lost", "version": 1}) if method == "POST" else None
        names = {
            "Content-Type": "application/json",
            **{name.replace("_", "-"): value for name, value in headers.items()},
        }
        connection.request(method, path, body=body, headers=names)
        answer = connection.getresponse()
        answer.read()
        connection.close()
        return answer.status

    own = f"http://127.0.0.1:{address.port}"
    assert status("GET", address.path) == 200
    assert status("GET", address.path.rstrip("/")) == 308
    for path in (
        "/",
        "/" + "0" * 32 + "/",
        address.path + "../../etc/passwd",
        address.path + "a gear.json".replace(" ", "%20"),
    ):
        assert status("GET", path) == 404, path
    assert status("GET", address.path, Host=f"evil.example:{address.port}") == 403
    assert status("GET", address.path, Origin="http://evil.example") == 403
    assert status("GET", address.path, Sec_Fetch_Site="cross-site") == 403
    save = address.path + "save"
    assert status("POST", save) == 403
    assert status("POST", save, Origin="http://evil.example") == 403
    assert status("POST", save, Origin=own, Content_Type="text/plain") == 415
    assert status("GET", save) == 405
    assert live.file.read_text(encoding="utf-8") == GEAR
    assert status("POST", save, Origin=own) == 200
    assert live.file.read_text(encoding="utf-8") == "lost"


@pytest.mark.parametrize(("scheme", "width"), [("light", 1500), ("dark", 390)])
def test_axe_finds_nothing_serious(scheme: str, width: int, serve: Serve) -> None:
    shown = serve(GEAR).open(width, 900, scheme)
    assert inaccessible(shown) == []
    edit(shown, '"shape": "uniform_rod"', '"shape": "rod"')
    settled(shown)
    assert inaccessible(shown) == []
