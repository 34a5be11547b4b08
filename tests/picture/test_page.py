"""The report page in a real browser, headless Chromium: what it shows, what it does, and that it loads nothing."""

import base64
import contextlib
import io
import json
import math
import shutil
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest
from PIL import Image
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.wait import WebDriverWait

import skinslide
import stages
from skinslide import BakeReport, bake
from skinslide.arrays.records import PatchResult
from skinslide.command.cli import main
from skinslide.picture.embedded import bytes_of_each, compressed
from skinslide.picture.page import Strip, page
from skinslide.problems import Problem
from skinslide.shot.report import PatchReport
from skinslide.shot.rows import Rows

SHEET, RING, STILL = "/World/char/sheet_GEO", "/World/char/ring_GEO", "/World/char/still_GEO"
FRAMES = [1001.0, 1002.0, 1003.0, 1004.0, 1004.5, 1005.0]
RING_FRAMES = [1002.0, 1004.0]
SETTINGS = {"force density rule": "unit", "holes": "pinned"}
FACTS = {"stage": "shot/patches.skinslide", "lookup": "exact"}
RATE = 24.0
ODD = """<b>"é' & 肘 </script><!--"""
SECONDS = 20  # until what does not happen counts as a failure


# ---- A baked shot, and pictures of it ----


@pytest.fixture(scope="module")
def report() -> BakeReport:
    """Three meshes baked: at all frames, at two of them, and with but a default value."""
    stage = stages.new_stage()
    for path, frames, faces in ((SHEET, FRAMES, None), (RING, RING_FRAMES, stages.annulus()), (STILL, [], None)):
        shape = stages.grid()
        mesh = stages.add_mesh(stage, shape, path, frames, rest="" if not frames else "points")
        if not frames:
            stages.set_primvar(mesh, "rest", mesh.GetPointsAttr().GetTypeName(), "vertex", stages.vectors(shape.points))
            mesh.GetPointsAttr().Set(stages.vectors(shape.moved(FRAMES[2])))
        stages.add_patch(mesh, shape.all_faces if faces is None else faces)
    baked = bake(stage, frames="authored")
    assert [mesh.patches[0].frames for mesh in baked.meshes] == [FRAMES, RING_FRAMES, [None]]
    return baked


def picture(number: int, kind: str = "PNG") -> bytes:
    """A small picture unlike that of any other number."""
    pixels = np.random.default_rng(number).integers(0, 256, (6, 16, 3), np.uint8)
    with io.BytesIO() as out:
        Image.fromarray(pixels).save(out, kind)
        return out.getvalue()


def strip(prim: str, patch: PatchReport, first: int = 0, **changes) -> Strip:
    """A patch with a picture a frame in two views, one of PNGs and one of JPEGs."""
    numbers = range(first, first + len(patch.frames))
    pictures = {"chequer": [picture(i) for i in numbers], "stretch": [picture(i + 1000, "JPEG") for i in numbers]}
    return replace(Strip(prim, patch, pictures, SETTINGS), **changes)


def strips_of(report: BakeReport) -> list[Strip]:
    return [strip(mesh.path, mesh.patches[0], 100 * i) for i, mesh in enumerate(report.meshes)]


def rows(results: Iterable[PatchResult]) -> Rows[PatchResult]:
    return Rows(PatchResult, results)


def longer(patch: PatchReport, frames: list[float | None]) -> PatchReport:
    """A patch with its results over and over."""
    return PatchReport(patch.info, frames, rows(patch.results[i % len(patch.results)] for i in range(len(frames))))


# ---- The browser ----


@pytest.fixture(scope="module")
def driver(tmp_path_factory):
    programs = {name: shutil.which(name) for name in ("chromium", "chromedriver")}
    assert all(programs.values()), f"the Debian packages chromium and chromium-driver are needed: {programs}"
    options = webdriver.ChromeOptions()
    options.binary_location = programs["chromium"]
    for argument in (
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--disable-dev-shm-usage",
        "--window-size=1280,900",
        f"--user-data-dir={tmp_path_factory.mktemp('chromium')}",
    ):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(programs["chromedriver"]))
    yield driver
    driver.quit()


class Shown:
    """A page that is open in the browser."""

    def __init__(self, driver: webdriver.Chrome, path: Path):
        self.driver, self.url = driver, path.as_uri()
        self.requests()
        driver.get_log("browser")
        driver.get(self.url)

    def all(self, selector: str, within=None) -> list:
        return (within or self.driver).find_elements(By.CSS_SELECTOR, selector)

    def one(self, selector: str, within=None):
        (found,) = self.all(selector, within)
        return found

    def run(self, script: str, *arguments):
        return self.driver.execute_script(script, *arguments)

    def press(self, *keys: str) -> None:
        ActionChains(self.driver).send_keys(*keys).perform()

    def next_paint(self) -> None:
        self.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()))"
        )

    def wait(self, condition) -> None:
        WebDriverWait(self.driver, SECONDS, 0.02).until(lambda _: condition())

    @property
    def frame(self) -> str:
        return self.one("#number").text

    @property
    def sections(self) -> list:
        return self.all(".strip")

    def pictures(self) -> list[bytes]:
        """The bytes of every picture to be seen, which the browser could decode."""
        images = [image for image in self.all(".picture img:not(.over)") if image.is_displayed()]
        for image in images:
            self.wait(lambda image=image: image.get_property("complete") and image.get_property("naturalWidth") == 16)
        return [base64.b64decode(image.get_property("src").partition("base64,")[2], validate=True) for image in images]

    def legend(self, chart) -> dict[str, str]:
        pairs = self.all(".legend div", chart)
        return {self.one("dt", pair).text: self.one("dd", pair).text for pair in pairs}

    def go_to(self, index: int) -> None:
        self.run(
            "const s = document.getElementById('frame'); s.value = arguments[0]; s.dispatchEvent(new Event('input'))",
            index,
        )

    def look_at(self, view: str) -> None:
        """Chooses one view, or with "" all."""
        self.run(
            "for (const each of document.getElementsByName('view')) if (each.value === arguments[0]) each.click()", view
        )

    def messages(self) -> list[str]:
        """What the page's console says since it was last asked."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def requests(self) -> set[str]:
        """Every address asked for since this was last asked, but what the page and the browser hold themselves."""
        events = [json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")]
        sent = [event["params"]["request"]["url"] for event in events if event["method"] == "Network.requestWillBeSent"]
        return {url for url in sent if not url.startswith(("data:", "chrome:", "chrome-untrusted:"))}


@pytest.fixture
def open_file(driver):
    """Opens a page from a file; the console stays empty and nothing else is requested."""
    opened = []

    def open_page(path: Path) -> Shown:
        opened.append(Shown(driver, path))
        return opened[-1]

    yield open_page
    for shown in opened[-1:]:
        assert shown.messages() == []
        assert shown.requests() <= {shown.url}


@pytest.fixture
def show(open_file, tmp_path):
    """Opens a page of strips."""

    def open_page(strips, report=None, title="Shot", facts=FACTS, rate=RATE) -> Shown:
        path = tmp_path / "page.html"
        path.write_text(page(title, strips, report or BakeReport([]), facts, rate), encoding="utf-8")
        return open_file(path)

    return open_page


@pytest.fixture
def shot(show, report) -> Shown:
    """The page at the first frame, in the first view."""
    shown = show(strips_of(report), report)
    shown.look_at("chequer")
    shown.go_to(0)
    return shown


# ---- The command's ----


def test_the_command_makes_a_page(open_file, tmp_path):
    """With no folder of pictures; its frames are the stage's, and each has another picture."""
    stage, _mesh = stages.patched_stage()
    path = stages.save(stage, tmp_path / "shot.usda")
    html = tmp_path / "report.html"
    assert main(["preview", str(path), "--html", str(html), "--size", "64x32", "--quiet"]) == 0
    assert sorted(file.name for file in tmp_path.iterdir()) == ["report.html", "shot.usda"]
    shown, seen = open_file(html), set()
    for index, frame in enumerate(stages.FRAMES):
        shown.go_to(index)
        assert shown.frame == f"{frame:g}"
        (image, _) = (image for image in shown.all(".picture img:not(.over)") if image.is_displayed())
        shown.wait(lambda image=image: image.get_property("naturalWidth") == 64)
        seen.add(image.get_property("src"))
    assert len(seen) == len(stages.FRAMES)
    text = shown.one("body").text
    for words in ("shot.usda", "unit", "pinned", "points (default)", stages.PATCH):
        assert words in text


# ---- The file ----


def test_the_same_arguments_give_the_same_page(report):
    pages = {page("Shot", strips_of(report), report, FACTS, RATE) for _ in range(2)}
    assert len(pages) == 1


def test_the_policy_stops_what_the_page_does_not_hold(show, report, driver):
    shown = show(strips_of(report), report)
    refused = driver.execute_async_script(
        """const done = arguments[0], refused = [];
        document.addEventListener("securitypolicyviolation", (event) => {
          if (refused.push(event.effectiveDirective) === 3) done(refused.sort());
        });
        for (const [tag, name, value] of [["img", "src", "https://example.org/a.png"],
                                          ["script", "textContent", "window.injected = true"],
                                          ["style", "textContent", "body { display: none }"]]) {
          const element = document.createElement(tag);
          element[name] = value;
          document.body.append(element);
        }"""
    )
    assert refused == ["img-src", "script-src-elem", "style-src-elem"]
    assert shown.run("return window.injected") is None
    # What the other tests look for is there to be found: the attempt, and a message for each refusal.
    assert shown.requests() == {shown.url, "https://example.org/a.png"}
    assert len(shown.messages()) == 3


# ---- Where it opens ----


def most_gained(report: BakeReport) -> float:
    """The frame at which most stretch is removed, of all patches together."""

    def gained(frame: float) -> float:
        results = [patch.results[at(patch.frames, frame)] for mesh in report.meshes for patch in mesh.patches]
        return sum(result.stretch_before - result.stretch_after for result in results)

    return max(FRAMES, key=gained)


def test_it_opens_where_most_is_gained(show, report):
    shown = show(strips_of(report), report)
    assert shown.frame == f"{most_gained(report):g}" != f"{FRAMES[0]:g}"
    samples = [at(each.patch.frames, most_gained(report)) for each in strips_of(report)]
    both = [
        [each.pictures[view][sample] for view in ("chequer", "stretch")]
        for each, sample in zip(strips_of(report), samples, strict=True)
    ]
    assert shown.pictures() == [picture for pair in both for picture in pair]


def test_where_nothing_is_gained_it_opens_at_the_worst_frame(show, report):
    patch = report.meshes[0].patches[0]
    still = [result._replace(stretch_after=result.stretch_before) for result in patch.results]
    shown = show([strip(SHEET, PatchReport(patch.info, patch.frames, rows(still)))])
    assert shown.frame == f"{patch.frames[patch.worst]:g}"


# ---- Before and after in one place ----

# How many of its two columns are seen of each picture.
IN_PAIRS = """return [...document.querySelectorAll(".picture:not([hidden]) img:not(.over)")].map((image) =>
  Math.round(2 * image.parentElement.getBoundingClientRect().width / image.getBoundingClientRect().width))"""


def wiped(shown: Shown) -> tuple[float, list[float]]:
    """Where the wipe is, 0 to 100, and where the first picture's column of before ends, as a share of what is seen."""
    return shown.run(
        r"""const seen = (over) => {
          const box = over.parentElement.getBoundingClientRect(), own = over.getBoundingClientRect();
          const cut = parseFloat(getComputedStyle(over).clipPath.match(/inset\(0px ([0-9.e-]+)/)[1]) / 100;
          return (own.left + own.width * (1 - cut) - box.left) / box.width;
        };
        return [Number(document.getElementById("wipe").value),
                [...document.querySelectorAll(".picture:not([hidden]) .over")].map(seen)];"""
    )


@pytest.mark.parametrize(("key", "share"), [("a", 100), ("b", 0)])
def test_before_and_after_alone(shot, key, share):
    shot.press(key)
    at_, seen = wiped(shot)
    assert at_ == share and seen == pytest.approx([share / 100] * 3, abs=0.01)


def test_a_drag_over_a_picture_wipes(shot):
    pair = shot.all(".picture:not([hidden]) .pair")[0]
    width = pair.rect["width"]
    ActionChains(shot.driver).move_to_element_with_offset(pair, round(width / 4), 2).click().perform()
    share, seen = wiped(shot)
    assert share == pytest.approx(75, abs=1) and seen == pytest.approx([share / 100] * 3, abs=0.01)
    shot.one("#wipe").send_keys(Keys.ARROW_LEFT)
    assert wiped(shot)[0] == pytest.approx(share - 1) and shot.frame == "1001"


def test_flicker_takes_turns(shot):
    seen = set()
    shot.press("f")
    shot.wait(lambda: seen.add(wiped(shot)[0]) or seen >= {0, 100})
    shot.press("f")
    assert shot.one("#flicker").get_attribute("aria-pressed") == "false"
    still = wiped(shot)
    shot.next_paint()
    assert wiped(shot) == still


def test_side_by_side_by_a_key(shot):
    assert shot.run(IN_PAIRS) == [1, 1, 1]
    shot.press("w")
    assert shot.run(IN_PAIRS) == [2, 2, 2] and not any(over.is_displayed() for over in shot.all(".over"))
    shot.press("w")
    assert shot.run(IN_PAIRS) == [1, 1, 1]


def test_the_column_beside_the_cache_is_chosen(show, report):
    """Of three, each a quarter of the picture."""
    names = ("before", "unit", "even", "relaxed")
    shown = show([strip(SHEET, report.meshes[0].patches[0], columns=names)], report)
    lefts = []
    for label in shown.all(".columns label"):
        label.click()
        lefts.append(
            shown.run(
                """const image = document.querySelector(".picture img:not(.over)"), box = image.getBoundingClientRect();
                return 4 * (image.parentElement.getBoundingClientRect().left - box.left) / box.width;"""
            )
        )
    assert lefts == pytest.approx([1, 2, 3], abs=0.01)
    assert [name.text for name in shown.all(".picture:first-of-type .name") if name.is_displayed()] == [
        "before",
        "relaxed",
    ]


def test_before_and_after_are_told_by_numbers(shot, report):
    """Over a picture that is wiped, too; of the frame that is shown."""
    for index in (0, 2):
        shot.go_to(index)
        result = report.meshes[0].patches[0].results[index]
        names = [name.text for name in shot.all(".picture:first-of-type .name", shot.sections[0])]
        assert names[:2] == [f"before {result.stretch_before:.4f}", f"after {result.stretch_after:.4f}"]


def test_side_by_side_names_stand_over_their_columns(show, report):
    names = ("before", "unit", "even", "relaxed")
    shown = show([strip(SHEET, report.meshes[0].patches[0], columns=names)], report)
    shown.press("w")
    lefts = shown.run(
        """const box = document.querySelector(".pair").getBoundingClientRect();
        return [...document.querySelectorAll(".picture:first-of-type .name")].map(
            (name) => (4 * (name.getBoundingClientRect().left - box.left)) / box.width);"""
    )
    assert lefts == pytest.approx([0, 1, 2, 3], abs=0.01)


def test_rules_that_are_compared_have_a_curve_each(show, report):
    patch = report.meshes[0].patches[0]
    left = {rule: list(share * patch.column("stretch_before")) for rule, share in (("unit", 0.75), ("even", 0.5))}
    shown = show([strip(SHEET, patch, columns=("before", *left), compared=left)], report)
    worst = patch.results[patch.worst].stretch_before
    shown.go_to(patch.worst)
    stretch = shown.all(".chart")[0]
    assert shown.legend(stretch) == {name: f"{share * worst:.4f}" for name, share in
                                     (("before", 1), ("unit", 0.75), ("even", 0.5))}  # fmt: skip
    assert len(shown.all("polyline", stretch)) == 3
    minus = "\N{MINUS SIGN}"
    lead = shown.one(".lead").text
    assert f"unit {0.75 * worst:.4f} {minus}25 %" in lead and f"even {0.5 * worst:.4f} {minus}50 %" in lead


# ---- A strip of frames ----


def test_stills_lead_to_their_frames(shot, report):
    stills = shot.all(".film .still", shot.sections[0])
    assert [still.text for still in stills] == [f"{frame:g}" for frame in FRAMES]
    assert shot.one(".film .current", shot.sections[0]).text == "1001"
    shot.one("button", stills[3]).click()
    assert shot.frame == "1004" and shot.one(".film .current", shot.sections[0]).text == "1004"


def test_a_film_of_many_frames_is_short(show, report):
    frames = [1.0 + i for i in range(600)]
    shown = show([strip(SHEET, longer(report.meshes[0].patches[0], frames))], report)
    stills = shown.all(".film .still")
    assert len(stills) == 16 and (stills[0].text, stills[-1].text) == ("1", "600")


def test_pictures_in_full_size_are_beside_the_page(open_file, tmp_path):
    stage, _mesh = stages.patched_stage()
    path = stages.save(stage, tmp_path / "shot.usda")
    html = tmp_path / "page" / "report.html"
    html.parent.mkdir()
    words = ["-o", str(tmp_path / "a folder"), "--html", str(html), "--size", "64x32", "--quiet"]
    assert main(["preview", str(path), *words]) == 0
    shown = open_file(html)
    for index, frame in enumerate(stages.FRAMES):
        shown.go_to(index)
        link = shown.all(".full")[0].get_property("href")
        file = Path(unquote(link.removeprefix("file://")))
        assert file.is_file() and file.parent == tmp_path / "a folder" and f".{frame:g}." in file.name


# ---- Pictures under the scrubber ----


def at(frames: list[float | None], frame: float) -> int:
    """Which of a patch's frames is shown at a frame: itself, else the last before, else the first."""
    return max([i for i, known in enumerate(frames) if known is not None and known <= frame], default=0)


def test_each_frame_shows_its_pictures(shot, report):
    slider, strips = shot.one("#frame"), strips_of(report)
    slider.send_keys(Keys.HOME)
    for i, frame in enumerate(FRAMES):
        if i:
            slider.send_keys(Keys.ARROW_RIGHT)
        assert shot.frame == f"{frame:g}" and slider.get_attribute("aria-valuetext") == f"frame {frame:g}"
        assert shot.pictures() == [each.pictures["chequer"][at(each.patch.frames, frame)] for each in strips]
    slider.send_keys(Keys.ARROW_RIGHT)
    assert shot.frame == "1005"


def test_a_patch_without_the_frame_says_what_it_shows(shot):
    def told():
        captions = [shot.one(".picture:not([hidden]) .at", section).text for section in shot.sections]
        return captions, [shot.one(".held", section).text for section in shot.sections]

    assert told() == (["frame 1001", "frame 1002", "default value"], ["", "has no frame 1001", ""])
    shot.go_to(3)
    assert told() == (["frame 1004", "frame 1004", "default value"], ["", "", ""])
    shot.go_to(5)
    assert told() == (["frame 1005", "frame 1004", "default value"], ["", "has no frame 1005", ""])


def test_arrow_keys_step_anywhere(shot):
    shot.press(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
    assert shot.frame == "1003"
    shot.press(Keys.ARROW_LEFT, Keys.ARROW_LEFT, Keys.ARROW_LEFT)
    assert shot.frame == "1001"


def test_the_view_is_switched_by_pointer_and_by_key(shot, report):
    strips = strips_of(report)
    shot.go_to(2)
    shot.one(".views label:nth-of-type(3)").click()
    stretch = [each.pictures["stretch"][at(each.patch.frames, FRAMES[2])] for each in strips]
    assert shot.pictures() == stretch
    shot.press(Keys.ARROW_LEFT)  # in the group, where it chooses
    assert shot.pictures() == [each.pictures["chequer"][at(each.patch.frames, FRAMES[2])] for each in strips]
    assert shot.frame == "1003"


def test_a_patch_without_the_view_shows_another(show, report):
    first, second, _ = strips_of(report)
    second = replace(second, pictures={"weight": [picture(7), picture(8)]})
    shown = show([first, second], report)
    shown.go_to(0)
    shown.one(".views label:nth-of-type(3)").click()
    assert shown.pictures() == [first.pictures["stretch"][0], picture(7)]
    shown.one(".views label:nth-of-type(4)").click()
    assert shown.pictures() == [first.pictures["chequer"][0], picture(7)]


# ---- Playing ----


@pytest.mark.parametrize("start", ["key", "button"])
def test_it_plays_and_pauses(shot, start):
    def toggle():
        if start == "key":
            shot.press(Keys.SPACE)
        else:
            shot.one("#play").click()

    toggle()
    assert shot.one("#play").get_attribute("aria-pressed") == "true"
    seen = set()
    shot.wait(lambda: seen.add(shot.frame) or seen >= {"1001", "1003", "1005"})  # it starts again at the end
    toggle()
    assert shot.one("#play").get_attribute("aria-pressed") == "false"
    stopped = shot.frame
    shot.next_paint()
    assert shot.frame == stopped


def test_it_plays_no_faster_than_the_stage(show, report):
    """At 10 time codes a second, 1003 comes 0.2 s after 1001, and 1005 0.4 s after."""
    shown = show(strips_of(report), report, rate=10.0)
    times = shown.driver.execute_async_script(
        """const done = arguments[0], number = document.getElementById("number"), times = {};
        const start = performance.now();
        new MutationObserver((_, observer) => {
          times[number.textContent] ??= performance.now() - start;
          if (number.textContent === "1005") { observer.disconnect(); done(times); }
        }).observe(number, { childList: true });
        document.getElementById("play").click();"""
    )
    for frame, time in times.items():
        assert time >= 100 * (float(frame) - FRAMES[0]) - 1


# ---- Curves ----


def read_axis(shown: Shown, chart, axis: str) -> tuple[np.ndarray, np.ndarray]:
    """Where the ticks of a chart are, in the drawing's units, and the numbers at them."""
    end = f"{axis}1"
    ticks = shown.all(f".{axis}.tick", chart)
    places = [float(shown.one("line", tick).get_attribute(end)) for tick in ticks]
    return np.array(places), np.array([float(shown.one("text", tick).text) for tick in ticks])


def read_line(shown: Shown, chart, style: str) -> np.ndarray:
    """A curve as one reads it: (frames, 2) numbers by the ticks of both axes."""
    pairs = [pair.split(",") for pair in shown.one(f"polyline.{style}", chart).get_attribute("points").split()]
    drawn = np.array(pairs, np.float64)
    for i, axis in enumerate("xy"):
        places, numbers = read_axis(shown, chart, axis)
        slope, start = np.polyfit(places, numbers, 1)
        drawn[:, i] = slope * drawn[:, i] + start
    return drawn


def expected_curves(patch: PatchReport) -> list[dict[str, np.ndarray]]:
    """By chart and line, straight from the results."""
    stretch = {when: [getattr(r, f"stretch_{when}") for r in patch.results] for when in ("before", "after")}
    slide = {"after": [r.largest_slide for r in patch.results]}
    counts = {"folded": [r.folded_faces for r in patch.results], "clamped": [r.clamped_vertices for r in patch.results]}
    stages = ("density", "embed", "locate", "interpolate")
    times = {stage: [1e3 * getattr(r, f"{stage}_seconds") for r in patch.results] for stage in stages}
    times["total"] = [sum(each) for each in zip(*times.values(), strict=True)]
    return [{name: np.array(line) for name, line in chart.items()} for chart in (stretch, slide, counts, times)]


@pytest.mark.parametrize("which", [0, 1])
def test_curves_are_at_their_values(shot, report, which):
    patch = report.meshes[which].patches[0]
    charts = shot.all(".chart", shot.sections[which])
    for chart, lines in zip(charts, expected_curves(patch), strict=True):
        assert {line.get_attribute("class") for line in shot.all("polyline", chart)} == set(lines)
        for style, values in lines.items():
            read = read_line(shot, chart, style)
            highest = read_axis(shot, chart, "y")[1].max()
            # Coordinates have two decimals, on some 110 units of height and 260 of width.
            np.testing.assert_allclose(read[:, 1], values, rtol=0, atol=1e-4 * highest)
            np.testing.assert_allclose(read[:, 0], patch.frames, rtol=0, atol=1e-4 * np.ptp(patch.frames))
            assert values.max() <= highest


def test_marks_and_values_follow_the_scrubber(shot, report):
    for index, frame in enumerate(FRAMES):
        shot.go_to(index)
        for section, mesh in zip(shot.sections, report.meshes, strict=True):
            sample = at(mesh.patches[0].frames, frame)
            result = mesh.patches[0].results[sample]
            stretch, slide, counts, times = shot.all(".chart", section)
            before, after = f"{result.stretch_before:.4f}", f"{result.stretch_after:.4f}"
            assert shot.legend(stretch) == {"before": before, "after": after}
            assert float(shot.legend(slide)["slide"]) == pytest.approx(result.largest_slide, rel=2e-3, abs=1e-3)
            assert shot.legend(counts) == {"folded faces": "0", "clamped vertices": "0"}
            assert shot.legend(times)["embed"] == f"{1e3 * result.embed_seconds:.2f}"
            assert_marked(shot, stretch, sample)


def assert_marked(shown: Shown, chart, sample: int) -> None:
    """The cursor and the marks are at a sample of every line."""
    for style in ("before", "after"):
        point = shown.one(f"polyline.{style}", chart).get_attribute("points").split()[sample].split(",")
        mark = shown.one(f"circle.{style}", chart)
        marked = [float(mark.get_attribute(name)) for name in ("cx", "cy")]
        assert marked == pytest.approx([float(number) for number in point], abs=1e-3)
    cursor = shown.one(".cursor", chart)
    assert float(cursor.get_attribute("x1")) == float(cursor.get_attribute("x2")) == pytest.approx(marked[0], abs=1e-3)


def move_over(shown: Shown, chart, sample: int, style: str = "after") -> ActionChains:
    """The pointer above a sample of a curve."""
    x, y, middle_x, middle_y = shown.run(
        """const svg = arguments[0].querySelector("svg"), box = svg.getBoundingClientRect();
        svg.scrollIntoView({ block: "center" });
        const { x, y } = arguments[0].querySelector(`polyline.${arguments[1]}`).points[arguments[2]];
        return [x, y, 300, 140].map((units) => units * box.width / 300);""",
        chart,
        style,
        sample,
    )
    offset = round(x - middle_x / 2), round(y - middle_y / 2) - 3
    return ActionChains(shown.driver).move_to_element_with_offset(shown.one("svg", chart), *offset)


def test_over_a_curve_its_values_show(shot, report):
    chart = shot.all(".chart", shot.sections[0])[0]
    move_over(shot, chart, 2).perform()
    shot.wait(lambda: shot.one(".at", chart).text == "frame 1003")
    result = report.meshes[0].patches[0].results[2]
    assert shot.legend(chart)["before"] == f"{result.stretch_before:.4f}"
    assert_marked(shot, chart, 2)
    assert shot.frame == "1001"
    ActionChains(shot.driver).move_to_element(shot.one("h1")).perform()
    shot.wait(lambda: shot.one(".at", chart).text == "frame 1001")
    assert shot.legend(chart)["before"] == "0.0000"


def test_a_click_in_a_curve_goes_there(shot, report):
    chart = shot.all(".chart", shot.sections[1])[0]
    move_over(shot, chart, 1).click().perform()
    shot.wait(lambda: shot.frame == "1004")
    assert shot.pictures()[:2] == [
        each.pictures["chequer"][i] for each, i in zip(strips_of(report), (3, 1), strict=False)
    ]


# ---- Words and tables ----


def test_every_patch_is_summed_up(shot, report):
    rows = [row.text.split() for row in shot.all(".summary tbody tr")]
    for cells, mesh, section in zip(rows, report.meshes, shot.sections, strict=True):
        patch = mesh.patches[0]
        worst = max(patch.results, key=lambda result: result.stretch_before)
        frame = patch.frames[patch.results.index(worst)]
        assert cells[:2] == [stages.PATCH, mesh.path]
        assert cells[2] == ("default" if frame is None else f"{frame:g}")
        before, after = f"{worst.stretch_before:.4f}", f"{worst.stretch_after:.4f}"
        change = f"{100 * (worst.stretch_after / worst.stretch_before - 1):+.0f} %".replace("-", "\N{MINUS SIGN}")
        assert cells[3:5] == [before, after] and " ".join(cells[5:7]) == change
        rough = [f"{patch.roughness:.2f}", f"{patch.roughest:g}"] if patch.motion else ["-"]
        assert cells[7 : 7 + len(rough)] == rough
        lead = shot.one(".lead", section).text
        assert lead.startswith(f"{before} → {after}") and change in lead


def test_a_worst_frame_is_one_click_away(shot):
    shot.one(".summary tbody tr:nth-child(2) button").click()
    assert shot.frame == "1004"


def test_problems_are_listed(show, report):
    problems = [
        Problem("warning", SHEET, stages.PATCH, 1003.0, "3 vertices looked up outside every face"),
        Problem("note", "", None, None, "a note on the stage as a whole"),
    ]
    warned = BakeReport(problems, report.meshes)
    shown = show(strips_of(report), warned)
    rows = shown.all(".problems tbody tr")
    assert len(rows) == len(warned.problems) >= 2
    for text in ("warning", SHEET, "1003", problems[0].message):
        assert text in rows[0].text
    assert problems[1].message in rows[1].text
    shown.one("button", rows[0]).click()
    assert shown.frame == "1003"


def test_settings_and_facts_are_shown(shot):
    assert [text for pair in FACTS.items() for text in pair] == shot.one(".facts").text.split("\n")
    for section in shot.sections:
        assert [text for pair in SETTINGS.items() for text in pair] == shot.one(".settings", section).text.split("\n")


def test_names_are_shown_as_they_are(show, report):
    patch = report.meshes[0].patches[0]
    odd = PatchReport(patch.info._replace(name=ODD), patch.frames, patch.results)
    pictures = {ODD: [picture(i) for i in range(len(FRAMES))]}
    warned = BakeReport([Problem("warning", ODD, ODD, None, ODD)])
    shown = show([strip(ODD, odd, pictures=pictures, settings={ODD: ODD})], warned, ODD, {ODD: ODD})
    assert shown.driver.title == ODD
    for selector in ("h1", "h2", ".facts dt", ".facts dd", ".settings dt", ".settings dd", ".summary a"):
        assert shown.one(selector).text == ODD, selector
    assert shown.one(".strip p.path").text.strip() == ODD
    assert shown.one(".problems td:last-child").text == ODD
    assert shown.one(".picture img:not(.over)").get_attribute("alt").startswith(f"{ODD}, {ODD}, before and after")
    assert shown.one(".views input").get_attribute("value") == ODD
    assert shown.all("b") == []
    shown.go_to(1)
    assert shown.pictures() == [picture(1)]


def test_names_that_are_no_text_are_shown_by_number(show, report):
    """Python has names of files whose bytes are not UTF-8."""
    shown = show(strips_of(report), facts={"stage": b"a\xff.usda".decode("utf-8", "surrogateescape")})
    assert shown.one(".facts dd").text == "a\\udcff.usda"


# ---- What may be missing ----


def test_a_still_has_no_scrubber(show, report):
    patch = report.meshes[2].patches[0]
    shown = show([strip(STILL, patch)], report)
    assert not shown.one(".frames").is_displayed() and shown.one(".views").is_displayed()
    assert [tick.text for tick in shown.all(".chart:first-child .x.tick")] == ["default"]
    shown.look_at("chequer")
    assert shown.pictures() == [picture(0)]
    shown.press(Keys.ARROW_RIGHT, Keys.SPACE)
    move_over(shown, shown.all(".chart")[0], 0).click().perform()
    assert {at.text for at in shown.all(".chart .at")} == {"default value"}


def test_one_frame(show, report):
    patch = report.meshes[0].patches[0]
    single = PatchReport(patch.info, [1003.25], rows(patch.results[2:3]))
    shown = show([strip(SHEET, single, pictures={"chequer": [picture(3)]})], report)
    assert not shown.one(".frames").is_displayed() and not shown.one(".views").is_displayed()
    assert [tick.text for tick in shown.all(".chart:first-child .x.tick")] == ["1003.25"]
    assert shown.pictures() == [picture(3)]


def test_no_stretch_is_no_change(show, report):
    """The first frame is the rest pose."""
    patch = report.meshes[0].patches[0]
    still = PatchReport(patch.info, FRAMES[:1], rows(patch.results[:1]))
    assert still.change is None
    shown = show([strip(SHEET, still)], report)
    assert shown.one(".lead").text == "0.0000 → 0.0000 stretch at frame 1001, the worst"
    for chart in shown.all(".chart")[:3]:
        assert read_axis(shown, chart, "y")[1][[0, -1]].tolist() == [0, 1]


def test_frames_as_far_apart_as_numbers_go(show, report):
    patch = longer(report.meshes[0].patches[0], [-1.5e308, 0.0, 1.5e308])
    shown = show([strip(SHEET, patch)])
    for line in shown.all("polyline"):
        x = [float(pair.split(",")[0]) for pair in line.get_attribute("points").split()]
        assert x[0] < x[1] < x[2] and x[2] - x[1] == pytest.approx(x[1] - x[0])
    assert [tick.text for tick in shown.all(".chart:first-child .x.tick text")] == ["-1.5e+308", "1.5e+308"]


def test_how_rough_skin_is_is_not_said_of_frames_far_apart(show, report):
    patch = report.meshes[0].patches[0]
    sparse = PatchReport(patch.info, [1001.0, 1003.0, 1005.0], rows(patch.results[:3]), patch.motion)
    assert sparse.roughness is not None
    cells = show([strip(SHEET, sparse)]).one(".summary tbody tr").text.split()
    assert cells[7] == "-" and cells[8] == f"{sparse.column('largest_slide').max():.4g}"


def test_no_patches(show):
    warned = BakeReport([Problem("warning", "", None, None, "there is no mesh with a patch")])
    shown = show([], warned)
    assert "There is no patch." in shown.one("main").text and "no mesh with a patch" in shown.one("main").text
    assert not shown.one(".player").is_displayed()
    shown.press(Keys.ARROW_RIGHT, Keys.SPACE)


def test_no_pictures(show, report):
    shown = show([strip(SHEET, report.meshes[0].patches[0], pictures={})], report)
    assert shown.all(".views") == shown.all(".wiping") == shown.all(".film") == []
    shown.go_to(0)
    shown.press(Keys.ARROW_RIGHT, "w", "a", "f")
    assert shown.one(".chart:first-child .at").text == "frame 1002"


def test_hundreds_of_frames(show, report):
    frames = [1.0 + i for i in range(600)]
    shown = show([strip(SHEET, longer(report.meshes[0].patches[0], frames))], report)
    shown.look_at("chequer")
    shown.one("#frame").send_keys(Keys.END)
    assert shown.frame == "600" and shown.pictures() == [picture(599)]
    assert len(shown.all(".chart:first-child .x.tick")) <= 7
    move_over(shown, shown.all(".chart")[0], 300).click().perform()
    # A pixel is some two frames.
    shown.wait(lambda: abs(float(shown.frame) - frames[300]) <= 2)


def test_without_the_script_a_frame_is_there(show, report, driver):
    """The one at which most is gained."""
    driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    try:
        shown = show(strips_of(report), report)
        samples = [at(each.patch.frames, most_gained(report)) for each in strips_of(report)]
        expected = [
            pictures[sample]
            for each, sample in zip(strips_of(report), samples, strict=True)
            for pictures in each.pictures.values()
        ]
        assert shown.pictures() == expected
        assert all(svg.is_displayed() for svg in shown.all(".chart svg")) and len(shown.all(".chart svg")) == 12
        assert not shown.one(".player").is_displayed() and shown.all("button") == shown.all(".player button")
        result = report.meshes[0].patches[0].results[samples[0]]
        assert shown.legend(shown.all(".chart")[0])["before"] == f"{result.stretch_before:.4f}"
        shown.one(".strip:first-of-type summary").click()
        assert [row.text.split()[0] for row in shown.all(".strip:first-of-type tbody tr")] == [f"{f:g}" for f in FRAMES]
    finally:
        driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


def test_bad_pictures(report):
    patch = report.meshes[0].patches[0]
    few = strip(SHEET, patch, pictures={"chequer": [picture(0)]})
    text = strip(SHEET, patch, pictures={"chequer": [picture(0), b"GIF89a", *map(picture, range(4))]})
    none = strip(SHEET, PatchReport(patch.info), pictures={})
    for bad, message in (
        (few, f"{SHEET}: patch {stages.PATCH}: 1 pictures of chequer for 6 frames"),
        (text, f"{SHEET}: patch {stages.PATCH}: frame 1002: the picture of chequer is not a PNG, JPEG or WebP"),
        (none, f"{SHEET}: patch {stages.PATCH}: no frames"),
    ):
        with pytest.raises(ValueError, match=message):
            page("Shot", [bad], report, FACTS)


@pytest.mark.parametrize("rate", [0.0, -24.0, math.nan, math.inf])
def test_a_rate_that_cannot_be_played(report, rate):
    with pytest.raises(ValueError, match="time codes per second"):
        page("Shot", strips_of(report), report, FACTS, rate)


# ---- On a phone, on paper, by ear ----


@contextlib.contextmanager
def screen(driver, width: int):
    """A browser window of a width; under 500 pixels, that of a phone."""
    metrics = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": width < 500}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    try:
        yield
    finally:
        driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


@pytest.mark.parametrize("width", [1280, 800, 400])
def test_it_fits_the_screen(shot, driver, width):
    with screen(driver, width):
        assert shot.run("return [innerWidth, document.documentElement.scrollWidth]")[1] <= width
        texts = shot.run(
            "return [...document.querySelectorAll('.chart text')].map((t) => t.getBoundingClientRect().height)"
        )
        assert 9 <= min(texts) <= max(texts) <= 20  # pixels


VIEWS = ("chequer", "stretch", "density", "slide", "texture")
RULES = ("before", "unit", "fast", "relaxed", "even")


@pytest.fixture
def every_view(show, report) -> Shown:
    """Every choice that there is: all views, and all rules."""
    strips = []
    for each in strips_of(report):
        pictures = {view: each.pictures["chequer"] for view in VIEWS}
        strips.append(replace(each, pictures=pictures, columns=RULES))
    return show(strips, report)


@pytest.mark.parametrize("width", [360, 390, 768, 1280])
def test_every_choice_is_within_the_screen(every_view, driver, width):
    with screen(driver, width):
        assert every_view.run("return document.documentElement.scrollWidth") <= width
        for choice in every_view.all(".choice label"):
            every_view.run("arguments[0].scrollIntoView({block: 'nearest', inline: 'nearest'})", choice)
            left, right = every_view.run(
                "const b = arguments[0].getBoundingClientRect(); return [b.left, b.right]", choice
            )
            assert 0 <= left < right <= width


@pytest.mark.parametrize("width", [390, 1280])
def test_a_link_leads_to_a_heading_in_sight(every_view, driver, width):
    """Below the player, which takes more lines the narrower the page is."""
    with screen(driver, width):
        every_view.next_paint()
        every_view.all(".summary a")[1].click()
        heading = "return arguments[0].getBoundingClientRect().top"
        player = every_view.run("return document.querySelector('.player').getBoundingClientRect().bottom")
        assert player <= every_view.run(heading, every_view.one("h2", every_view.sections[1])) < 800


def test_on_a_phone_the_gain_is_in_sight(shot, driver):
    with screen(driver, 390):
        change = shot.all(".summary tbody tr:first-child td")[3]
        assert change.text.endswith("%")
        assert shot.run("return arguments[0].getBoundingClientRect().right", change) <= 390


def test_many_problems_leave_room_for_the_pictures(show, report):
    report = replace(report, warnings=[Problem("warning", SHEET, "skin", None, f"warning {i}") for i in range(100)])
    shown = show(strips_of(report), report)
    assert len(shown.all(".problems tbody tr")) >= 100
    assert shown.run("return document.querySelector('.problems').offsetHeight") < 300


def test_it_is_light_dark_and_on_paper_light(shot, driver):
    def ink(media: str, scheme: str) -> float:
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": media, "features": features})
        return sum(shot.run("return getComputedStyle(document.body).color.match(/[0-9]+/g).map(Number)")) / 3

    try:
        assert ink("screen", "light") < 60 < 200 < ink("screen", "dark")
        a4 = {"width": 703, "height": 1032, "deviceScaleFactor": 1, "mobile": False}  # within the margins
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", a4)
        assert ink("print", "dark") < 60
        assert not shot.one(".player").is_displayed()
        assert len(shot.pictures()) == 3 and shot.run(IN_PAIRS) == [2, 2, 2]
        cut = "return [...document.querySelectorAll('.scroll')].some((box) => box.scrollWidth > box.clientWidth)"
        assert not shot.run(cut)
    finally:
        driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "", "features": []})


def test_everything_has_a_name_to_be_read_out(shot):
    for selector in ("button", "input", ".picture img:not(.over)", ".chart svg", "section", "fieldset", "a"):
        elements = [element for element in shot.all(selector) if element.is_displayed()]
        assert elements and all(element.accessible_name for element in elements), selector
    assert "before at most" in shot.one("#patch-0 .chart:first-child svg").accessible_name


# ---- Many shots ----


def test_a_page_of_many_shots_is_sorted_by_its_headings(open_file, tmp_path, capsys):
    for name, frames in (("first", "1001:1002"), ("second", "1001:1003"), ("third", "1001")):
        path = stages.save(stages.patched_stage()[0], tmp_path / f"{name}.usda")
        assert main(["preview", str(path), "--html", str(tmp_path / f"{name}.html"), "--frames", frames, "--json",
                     "--size", "32x16", "--quiet"]) == 0  # fmt: skip
        (tmp_path / f"{name}.json").write_text(capsys.readouterr().out)
    skinslide.report(tmp_path)
    shown = open_file(tmp_path / "shots.html")

    def names() -> list[str]:
        return [row.text.split(".usda")[0].split("/")[-1] for row in shown.all(".sorted tbody tr")]

    assert names() == ["second", "first", "third"]  # by what is left
    heading = shown.all(".sorted thead button")[8]
    heading.click()
    assert names() == ["second", "first", "third"] and heading.text == "frames"
    heading.click()
    assert names() == ["third", "first", "second"]
    shown.all(".sorted thead button")[0].click()
    assert names() == ["first", "second", "third"]
    assert shown.all(".sorted a")[0].get_property("href").endswith("/first.html")


# ---- Smaller pictures ----


def test_compressed_pictures_are_small_and_alike():
    """A smooth picture wider than a page: what is left is within a few steps of 255 of it, scaled."""
    across, down = np.meshgrid(np.linspace(0, 1, 3840), np.linspace(0, 1, 540))
    pixels = (255 * np.stack([across, down, across * down], axis=2)).astype(np.uint8)
    small = compressed(pixels)
    image = Image.open(io.BytesIO(small))
    assert (image.format, image.size) == ("WEBP", (1600, 225))
    assert Image.open(io.BytesIO(compressed(pixels, columns=4))).size == (3200, 450)  # of which one is seen at a time
    scaled = np.asarray(Image.fromarray(pixels).resize(image.size)).astype(int)
    assert np.abs(np.asarray(image) - scaled).max() < 12
    assert len(small) < pixels.size / 50


def test_a_page_of_many_patches_leaves_frames_out(show, report):
    """Of 20 patches, whose pictures are as small as they can be: still less than 10 MB."""
    patch = longer(report.meshes[0].patches[0], [float(frame) for frame in range(1, 241)])
    noise = np.random.default_rng(1)
    pictures = [{"chequer": [picture(0) + noise.bytes(3000) for _ in patch.frames]} for _ in range(20)]
    few = [strip(SHEET, patch, pictures=each) for each in pictures]
    shown = show(few, report)
    assert shown.run("return document.documentElement.outerHTML.length") < 10e6
    for index in (0, patch.worst, 101, 239):
        shown.go_to(index)
        at = shown.one(".picture .at", shown.sections[3]).text
        assert index + 1 - 3 < int(at.removeprefix("frame ")) <= index + 1
        assert shown.run("return document.querySelector('.picture img').complete")
    shown.go_to(patch.worst)
    assert shown.one(".picture .at", shown.sections[3]).text == f"frame {patch.worst + 1}"


def test_a_page_of_240_frames_may_be_sent_about():
    """A chequer of 40 by 20 bent squares, more than pictures have, in two views: all of it comes to less than 10 MB."""
    across, down = np.meshgrid(np.linspace(0, 1, 1920), np.linspace(0, 1, 1080))
    odd = (np.floor(40 * across + np.sin(5 * down)) + np.floor(20 * down + np.sin(9 * across))) % 2
    pixels = (odd[..., None] * [180, 170, 150] + 60 * across[..., None]).astype(np.uint8)
    made = compressed(pixels, bytes_of_each(2 * 240))
    assert 4 / 3 * 2 * 240 * len(made) < 9e6 and Image.open(io.BytesIO(made)).width >= 360
    assert len(compressed(pixels, bytes_of_each(10))) > 2 * len(made)
