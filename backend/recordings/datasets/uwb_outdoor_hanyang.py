"""uwb_outdoor_hanyang: a tag carried around a vehicle with four UWB anchors, in sight and obstructed.

The anchors' places in the vehicle's frame are in the data. There is no PDR; where the tag starts is unknown.
"""

from pathlib import Path

from backend.recordings.datasets.base import KNOWN_SIGMA_M, rows
from estimator.measurements import AnyReading, Node, Range

NAME = "uwb_outdoor_hanyang"
RECORDINGS = ("LOS_A1", "NLOS_A1")
ANCHORS = (3, 5, 9, 12)
TAG = "tag"


def readings(folder: Path, recording: str | None = None) -> list[AnyReading]:
    """The readings of one walk.

    Args:
        folder: where the walk's files `<recording>_A<anchor>.csv` are.
        recording: which walk.

    Raises:
        NotTheDataSet: a file is missing.
    """
    ranges: list[Range] = []
    places: dict[str, tuple[float, float, float]] = {}
    for number in ANCHORS:
        for row in rows(folder / f"{recording}_A{number}.csv"):
            anchor = f"anchor-{row.word('field.id')}"
            places[anchor] = (row.number("field.x"), row.number("field.y"), row.number("field.z"))
            # Stamps are whole nanoseconds, which a float of Unix seconds holds to 0.2 µs.
            t = row.whole("field.stamp") / 1e9
            measured_m = row.number("field.distanceFromTag")
            ranges.append(Range(t=t, a=TAG, b=anchor, range_m=measured_m, technology="uwb"))
    start = min(reading.t for reading in ranges)
    introduced: list[AnyReading] = [Node(t=start, node=TAG, role="responder", callsign="Tag")]
    introduced += [
        Node(t=start, node=anchor, role="anchor", position_m=place, sigma_m=KNOWN_SIGMA_M)
        for anchor, place in sorted(places.items())
    ]
    return [*introduced, *ranges]
