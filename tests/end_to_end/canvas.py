"""The map before the commander's eyes: which colours lie where on its canvas, and in which shape."""

from dataclasses import dataclass
from urllib.parse import quote

from playwright.sync_api import Page

from tests.running import eventually

# Crews take these colours in the order of their names.
FIRST_CREW = "#56b4e9"
SECOND_CREW = "#e69f00"
THIRD_CREW = "#009e73"
UAV = "#aab2ba"
# So are, by day, the lines of the first two: ellipses, trails, the edge of who is lost.
FIRST_LINE = "#448eb8"
SECOND_LINE = "#b37c00"
# The newest part of a trail lets the ground through.
FIRST_TRAIL = "#80b1cd"

_PIXELS = """(canvas, {colour, tolerance}) => {
  const wanted = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  const {width, height} = canvas;
  const ratio = width / canvas.clientWidth;
  const {data} = canvas.getContext('2d').getImageData(0, 0, width, height);
  let count = 0, x = 0, y = 0, left = width, right = 0, top = height, bottom = 0;
  for (let at = 0; at < data.length; at += 4) {
    if (wanted.some((value, part) => Math.abs(data[at + part] - value) > tolerance)) continue;
    const column = (at / 4) % width, row = Math.floor(at / 4 / width);
    count += 1; x += column; y += row;
    left = Math.min(left, column); right = Math.max(right, column);
    top = Math.min(top, row); bottom = Math.max(bottom, row);
  }
  const [middle_x, middle_y] = [canvas.clientWidth / 2, canvas.clientHeight / 2];
  const map = {middle_x, middle_y, drawn_height: height / ratio};
  if (count === 0) return {count, x: 0, y: 0, ...map, left: 0, right: 0, top: 0, bottom: 0};
  return {count: count / ratio ** 2, x: x / count / ratio, y: y / count / ratio, ...map,
          left: left / ratio, right: right / ratio, top: top / ratio, bottom: bottom / ratio};
}"""

_WIDTH_BETWEEN = """(canvas, {colour, top, bottom}) => {
  const wanted = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  const ratio = canvas.width / canvas.clientWidth;
  const [first, last] = [Math.round(top * ratio), Math.round(bottom * ratio)];
  const {data} = canvas.getContext('2d').getImageData(0, first, canvas.width, last - first + 1);
  let left = canvas.width, right = 0;
  for (let at = 0; at < data.length; at += 4) {
    if (wanted.some((value, part) => data[at + part] !== value)) continue;
    const column = (at / 4) % canvas.width;
    left = Math.min(left, column); right = Math.max(right, column);
  }
  return Math.max(0, right - left) / ratio;
}"""

_DRAWN = """async () => {
  for (let frame = 0; frame < 2; frame += 1) await new Promise(requestAnimationFrame);
}"""


@dataclass(frozen=True)
class Pixels:
    """Where on the map a colour lies (CSS pixels, y downwards): centroid and extent, and the map's middle.

    It was drawn for the map's own height, except in the one frame in which a row above it comes or goes.
    """

    count: float
    x: float
    y: float
    middle_x: float
    middle_y: float
    drawn_height: float
    left: float
    right: float
    top: float
    bottom: float

    @property
    def from_middle(self) -> tuple[float, float]:
        """Its centroid from the middle of the map, which stays where it is when rows come and go above it."""
        return self.x - self.middle_x, self.y - self.middle_y

    @property
    def of_this_height(self) -> bool:
        """Whether it was drawn for the height that the map has, and so is where the map shows its place."""
        return abs(self.drawn_height - 2 * self.middle_y) < 1

    @property
    def width(self) -> float:
        """From its leftmost to its rightmost pixel."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """From its topmost to its lowest pixel."""
        return self.bottom - self.top


class MapSeen:
    """What is seen on the map.

    Args:
        page: a page of the browser.
    """

    def __init__(self, page: Page) -> None:
        self.page = page

    def opens_before_anybody_is_there(self, url: str, incident: str) -> None:
        """Open the screen on an incident in which no responder is known yet."""
        self.page.goto(f"{url}/#incident={quote(incident)}")
        self.page.get_by_text("No responder has been heard of yet.").wait_for()

    def colour(self, colour: str, tolerance: int = 0) -> Pixels:
        """The pixels of the map within `tolerance` of a colour in each channel: a mark's are exact."""
        found = self.page.get_by_test_id("map").evaluate(_PIXELS, {"colour": colour, "tolerance": tolerance})
        return Pixels(**{name: float(value) for name, value in found.items()})

    def shape(self, colour: str) -> str:
        """The outline of a crew's one mark: round, diamond or square; "none" where there is no mark."""
        mark = self.colour(colour)
        if not mark.count:
            return "none"
        across = self.page.get_by_test_id("map").evaluate(
            _WIDTH_BETWEEN, {"colour": colour, "top": mark.top + 1, "bottom": mark.top + 0.25 * mark.height}
        )
        share = float(across) / mark.height
        # At a quarter of their height a circle is 0.87 as wide, a diamond 0.5, a square 1.
        return "diamond" if share < 0.68 else "round" if share < 0.93 else "square"

    def settled_mark(self, colour: str) -> Pixels:
        """A crew's mark once two looks, some frames apart, find it in one place of a map drawn to size."""
        seen: list[Pixels] = []

        def still() -> Pixels | None:
            # However slow the machine: what was to be drawn is drawn.
            self.page.evaluate(_DRAWN)
            seen.append(self.colour(colour))
            if len(seen) < 2 or not seen[-1].count or not seen[-1].of_this_height:
                return None
            before, now = seen[-2:]
            return now if abs(now.x - before.x) < 0.5 and abs(now.y - before.y) < 0.5 else None

        found = eventually(still, every_s=0.3)
        assert isinstance(found, Pixels)
        return found

    def is_under_a_button(self, mark: Pixels) -> bool:
        """Whether something else than the map is met by a finger in the middle of a mark, or at its edges."""
        met: list[str] = self.page.get_by_test_id("map").evaluate(
            """(map, places) => {
              const {left, top} = map.getBoundingClientRect();
              return places.map(([x, y]) => document.elementFromPoint(left + x, top + y)?.tagName);
            }""",
            [[x, y] for x in (mark.left, mark.x, mark.right) for y in (mark.top, mark.y, mark.bottom)],
        )
        return set(met) != {"CANVAS"}
