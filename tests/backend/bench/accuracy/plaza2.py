"""plaza2, as GTSAM ships it among its examples: a recording of which hardly anything was chosen in view.

The same robot as in plaza1 on another way, with a gyro that is biased by 0.4 degrees a second and whose scale
is off by 1.5 %.
"""

from pathlib import Path

import gtsam
import numpy as np
from scipy.io import loadmat

from backend.bench.accuracy.cases import Case, case_of


def plaza2(folder: Path) -> Case:
    """The recording as a case, by way of the files that plaza1 has.

    Args:
        folder: takes them.
    """
    recorded = loadmat(Path(gtsam.__file__).parent / "Data" / "Plaza2_.mat")
    truth, odometry, ranges, beacons = (recorded[name] for name in ("GT", "DR", "TD", "TL"))
    beacons[:, 1:3] -= truth[0, 1:3]
    truth[:, 1:3] -= truth[0, 1:3].copy()
    truth[:, 3] += np.pi  # the robot drives backwards
    into = folder / "plaza1"
    into.mkdir(exist_ok=True)
    for name, head, rows in (
        ("groundtruth", "t_s,x_m,y_m,heading_rad", truth),
        ("odometry", "t_s,dist_m,dheading_rad", odometry),
        ("beacons", "beacon_id,x_m,y_m", beacons),
        ("ranges", "t_s,sender_id,beacon_id,range_raw_m", ranges),
    ):
        formats = ["%d" if "_id" in column else "%.8f" for column in head.split(",")]
        np.savetxt(into / f"{name}.csv", rows, formats, delimiter=",", header=head, comments="")
    return case_of("plaza1", 0, folder)
