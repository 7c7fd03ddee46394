"""The readings that gateways post: one file a kind, with fields, units and bounds."""

from estimator.measurements.altitude import Altitude, Pressure
from estimator.measurements.bearing import Bearing
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.imu import Imu
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.measurements.rssi import Rssi
from estimator.measurements.status import Alarm, Status

__all__ = [
    "Alarm",
    "Altitude",
    "AnyReading",
    "Bearing",
    "Displacement",
    "Drop",
    "Imu",
    "Node",
    "Position",
    "Pressure",
    "Range",
    "Retire",
    "Rssi",
    "Status",
]

AnyReading = (
    Node
    | Drop
    | Displacement
    | Imu
    | Rssi
    | Range
    | Bearing
    | Position
    | Altitude
    | Pressure
    | Status
    | Alarm
    | Retire
)
"""Every kind of reading, told apart by its field `kind`."""
