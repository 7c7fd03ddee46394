"""Strategies for readings that are valid and otherwise anything: few nodes, so that they meet."""

from hypothesis import strategies as st

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

names = st.sampled_from(["base", "ff1", "ff2", "b1", "b2", "uav"])
epochs = st.one_of(
    st.floats(0.0, 30.0).map(lambda t: round(t, 1)),
    st.floats(0.0, 120.0),
    st.sampled_from([0.0, 1.0, 2.0, 4_102_444_800.0]),
)
lengths = st.one_of(st.floats(-30.0, 30.0), st.floats(-1e5, 1e5), st.just(0.0))
small = st.floats(-3.0, 3.0)
sigmas = st.one_of(st.none(), st.floats(0.01, 5.0), st.sampled_from([5e-324, 1e-9, 1e5]))
angles = st.one_of(st.floats(-7.0, 7.0), st.floats(-1e3, 1e3))
vectors = st.tuples(lengths, lengths, lengths)
headings = st.one_of(st.none(), angles)
pairs = st.tuples(names, names).filter(lambda p: p[0] != p[1])


def _pair(
    build: type[Range] | type[Rssi] | type[Bearing], **fields: st.SearchStrategy[object]
) -> st.SearchStrategy:
    return st.builds(
        lambda t, ends, values: build(t=t, a=ends[0], b=ends[1], **values),
        epochs,
        pairs,
        st.fixed_dictionaries(fields),
    )


readings = st.one_of(
    st.builds(
        Node,
        t=epochs,
        node=names,
        role=st.sampled_from(["base", "anchor", "beacon", "breadcrumb", "responder", "uav"]),
        position_m=st.one_of(st.none(), vectors),
        sigma_m=sigmas,
        heading_rad=headings,
        heading_sigma_rad=st.one_of(st.none(), st.sampled_from([1e-300, 0.1, 100.0])),
    ),
    st.builds(lambda t, ends: Drop(t=t, node=ends[0], by=ends[1]), epochs, pairs),
    st.builds(
        lambda t, node, delta, ago, heading, sigma: Displacement(
            t=t,
            node=node,
            delta_m=delta,
            from_t=None if ago is None else max(t - ago, 0.0),
            heading_rad=heading,
            sigma_m=sigma,
        ),
        epochs,
        names,
        st.one_of(st.tuples(small, small, small), vectors),
        st.one_of(st.none(), st.floats(0.0, 40.0)),
        headings,
        sigmas,
    ),
    _pair(Range, range_m=st.one_of(st.floats(0.0, 50.0), st.floats(0.0, 1e5)), sigma_m=sigmas,
          technology=st.sampled_from([None, "uwb", "rtt"])),
    _pair(Rssi, dbm=st.floats(-200.0, 100.0), tx_dbm=st.one_of(st.none(), st.floats(-200.0, 100.0))),
    _pair(Bearing, bearing_rad=angles, sigma_rad=st.sampled_from([None, 1e-300, 0.1]),
          frame=st.sampled_from(["enu", "body"])),
    st.builds(
        Position, t=epochs, node=names, position_m=vectors,
        sigma_m=st.one_of(st.none(), st.just((1.0, 1.0, 2.0)), st.just((1e-300, 1e5, 1.0))),
    ),
    st.builds(
        Position, t=epochs, node=names,
        wgs84=st.tuples(st.floats(-90.0, 90.0), st.floats(-180.0, 180.0), lengths),
    ),
    st.builds(Altitude, t=epochs, node=names, up_m=lengths, sigma_m=sigmas),
    st.builds(Pressure, t=epochs, node=names, pressure_pa=st.floats(1e4, 2e5), sigma_m=sigmas),
    st.builds(Status, t=epochs, node=names),
    st.builds(Alarm, t=epochs, node=names, alarm=st.just("mayday"), state=st.just("raised")),
    st.builds(
        lambda t, node, rate_hz, accel, gyro, count: Imu(
            t=t, node=node, rate_hz=rate_hz, accel_mps2=[accel] * count, gyro_radps=[gyro] * count
        ),
        epochs, names, st.sampled_from([0.1, 50.0, 200.0, 1e4]),
        st.one_of(st.just((0.0, 0.0, 9.8)), st.just((0.0, 0.0, 0.0)), st.tuples(*[st.floats(-1e4, 1e4)] * 3)),
        st.one_of(st.just((0.0, 0.0, 0.0)), st.tuples(*[st.floats(-1e3, 1e3)] * 3)), st.integers(1, 400),
    ),
    st.builds(Retire, t=epochs, node=names),
)  # fmt: skip
