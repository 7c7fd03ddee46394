"""The numbers of the default tracker: one set for every incident, from physics and published figures.

Physics leaves most of them a span. Some were chosen among what is plausible with recordings in view: the
public sets plaza1, danis and hanyang, and the scenarios of `estimator.simulate`. Accuracy on these is
therefore not accuracy on data never seen. They are `HEADING_WALK_RAD_PER_ROOT_M`, `SCALE_SIGMA`,
`RANGE_SCALE_WIDE`, `UNCALIBRATED`, `OBSTRUCTED_SCALE`, the bias of `uwb` in `RANGE_BIAS_SIGMA_M`,
`FLOOR_SIGMA`, `NEAR_SIGMA_DB`, `RSSI_POWER_DBM` and its sigma, `FREE_WAY_MPS`, `SLIP_M`, `SLIP_RARE`,
`WALL_M`, `EXCESS_M` and the two after it, `UNHEARD_MEMORY_S`, `SET_OFF_BIAS_RADPS` (with plaza2 in view as
well), `NO_BODY_M`, `CRAWLS_MPS`, `WALKS_MPS`, from which probability on bodies are taken to be seen, and that
the spread of gyro biases is uniform up to `BIAS_SIGMA_MOST_RADPS`, not in its logarithm.
"Measured" stands beside figures that public recordings show.

Some stand in compiled functions, which keep the number that they were compiled with: after a change remove
`__pycache__` (decision 0007).
"""

from math import radians, sqrt

from estimator.graph.robust import Mixture

TICK_S = 1.0
"""Readings of one tick are linearised together; what its bearer walks in it, the unit's own way takes out."""

FREE_TICK_S = 0.25
"""The same for nodes without PDR, whose velocity changes."""

# A PDR unit (foot-mounted, or wheels), where it does not tell its own sigma.
WALK_M_PER_ROOT_M = 0.035
"""Random error of a step, in any direction: 3.5 cm after 1 m, growing with the root of the way."""
STAND_M_PER_ROOT_S = 0.005
DISPLACEMENT_FLOOR_M = 0.005
CLIMB_M_PER_ROOT_M = 0.3
"""A unit that always reports no change of height measures none: its bearer may have taken a stair, three
metres up or down in a hundred metres of way."""
HEADING_WALK_RAD_PER_ROOT_M = radians(0.25)
"""A boot turns a little against the unit's frame with every step: a few tenths of a degree."""
GYRO_WALK_RAD_PER_ROOT_S = radians(0.03)
"""Angle random walk of a consumer MEMS gyro, 0.2 to 2 degrees per root hour, and a trembling foot."""
BIAS_SIGMA_MOST_RADPS = radians(0.5)
"""Gyro bias after the unit's own calibration at switch-on: nearly nil of a good unit, half a degree a second
of a cheap one once warm. How far those of a crew differ is anything up to that
(`fusion/learned/gyros.py`)."""
BIAS_WALK_RADPS_PER_ROOT_S = radians(0.001)
SET_OFF_BIAS_RADPS = radians(0.04)
"""A gyro's scale is good to 1 % (data sheets of LSM6DSO, ICM-20948), and who follows a wall turns round once
in a minute and a half: when he sets off, his bias seems to change by that."""
SCALE_SIGMA = 0.02
SCALE_WALK_PER_ROOT_S = 1e-5
STRAPDOWN_SCALE_SIGMA = 0.01
"""Of displacements that raw samples make: they are off by what accelerometers are, 1 % (data sheets of
LSM6DSO, BMI270). ZUPT-aided units err by 0.3 to 1 % of the way in all (Foxlin 2005; Nilsson 2013)."""
CRAWLS_MPS, WALKS_MPS = 0.7, 0.85
"""Whose unit tells a slower pace may crawl, until it tells a faster one: assumed, 0.6 m/s and what a unit may
tell too much of it. On clear floors and without gear students crawl at 0.8 m/s (Cao et al., Safety Science
104, 2018); who feels his way does not."""
CRAWL_SCALE_SIGMA = 0.1
"""What a unit makes of a crawl is off by so much of it: assumed. What samples make of simulated ones is 0.1
to 8 % off, 10 to 17 % where no boot ever rests (decision 0029)."""
BESIDE_M = 0.1
"""How far a bearer may be from where his boot stands in the middle of a stance, along each axis: a step is 10
to 15 cm wide, he leans, and 0.05 s of a walk are 6 cm."""
SLIP_M = 0.5
"""A stumble, a wheel that spins, a standstill that is missed: half a metre along each horizontal axis."""
SLIP_RARE = 5.0
"""Log odds against a slip in one step between two keyframes: one in five minutes."""
HEADING_SIGMA_RAD = 0.1
TURNED_SIGMA_RAD = 0.15
"""A heading that is less sure than this is tried all round: one radio leaves two, and what was told does not
tell them apart where they are as near to it as to each other."""
TURNS = 8
STILL_MPS = 0.03
STILL_TURN_RADPS = radians(3.0)
"""Slower than both, a unit stands still, and what it reports as turn is gyro bias (ZARU)."""
STILL_S, STILL_LONG_S = 5.0, 30.0
"""So long a standstill lasts that tells a bias, at least, and at most before it has told one and goes on."""
STILL_SILENT_S = 10.0
"""Who has reported nothing for longer may have turned meanwhile."""
STILL_READINGS = 6
STILL_JITTER_RAD, STILL_JITTER_READINGS = 0.01, 4.0
"""Half a degree of noise in a reported heading, before its own scatter has told; and as many readings that
is worth."""
SAGITTA_M = 0.2
"""By how much a way without a corner leaves its chord: that turns who goes it, and looks like gyro bias.
Measured: people on hanyang's square 0.17 and 0.19 m (rms), plaza1's mower 0.42 m, half of its ways 0.21 m."""
STRAIGHT_SHARED_RADPS = BIAS_SIGMA_MOST_RADPS / sqrt(3.0)
"""All ways of somebody may be bent alike, by a round building or by habit, and nothing tells that from his
gyro: by as much as gyros differ (the rms of spreads up to half a degree a second), so that half of what all
turn by is taken for either. It is a radius of 200 m at 1 m/s."""
STRAIGHT_MORE = 2.0
"""A leg under way tells again what it shows once that is so many times as much information."""
STRAIGHT_LEGS = 4.0
"""As how many legs the assumed straightness counts, beside what they differ by."""
CORNER_RAD = radians(20.0)
"""Who turns by more has turned a corner; half a degree a second is 8 degrees about half a minute's mean."""
CHORD_S, CHORD_M, CHORD_LONGEST_S = 0.99, 0.7, 4.0
"""A way is looked at by the stride: a boot swings while it goes. Who takes longer has stopped, or nobody
knows his way."""
CHORD_JITTER_RAD = 0.05
"""Directions of strides are off by so much, before their own scatter has told."""
FASTEST_MPS = 10.0
GAP_MPS = 1.0
"""In a time that a unit's reports leave out (`from_t` after its last one), its bearer may walk so fast."""
SILENT_SPEED_MPS, SILENT_MEMORY_S = 0.7, 1.0
"""While a unit reports nothing, its bearer walks about with so much along each horizontal axis: after some
seconds a random walk of 1 m per root second."""
UNHEARD_MEMORY_S = 5.0
"""Who is not heard of at all keeps his way for as long as those without PDR do: along a corridor."""

# Nodes without PDR: a velocity that is forgotten with time (Singer's model, for velocity).
SPEED_SIGMA_MPS: dict[str, tuple[float, float]] = {"responder": (1.0, 0.2), "uav": (5.0, 2.0)}
"""Usual speed of each role, along each horizontal axis and upwards."""
SPEED_MEMORY_S: dict[str, float] = {"responder": 5.0, "uav": 5.0}

SIGMA_FLOOR_M = 0.01
"""No position, range or fix is believed to be better: the radios themselves are larger."""
HEADING_FLOOR_RAD = 1e-3
ENTRY_SIGMA_M = (3.0, 3.0, 1.0)
"""Responders whose first position nobody gives enter at the base, within this."""
WAIT_FOR_RANGES_S = 10.0
DROP_SIGMA_M = (0.5, 0.5, 0.3)
ANCHOR_SIGMA_M = 0.05
SURVEY_SIGMA_M = 0.5
FIX_SIGMA_M = (3.0, 3.0, 5.0)
"""A GNSS fix without a sigma."""
ALTITUDE_SIGMA_M = 1.0
ABSOLUTE_SHARED = 0.5
FIX_MEMORY_S, FIX_MEMORY_M, HEIGHT_MEMORY_S = 60.0, 10.0, 30.0
"""Half of the variance of a fix or a height stays for so long, or for so much of a way: satellites' paths
around a house while one stands at its door; draught and weather, by which an altimeter is off."""
RECEIVER_MEMORY_S = 1800.0
"""All fixes of a receiver are off by about the same for so long: orbits, clocks and the ionosphere change
within tens of minutes, and what differs from second to second is decimetres."""
LATE_SIGMA_S = 0.5
"""How late fixes usually are: receivers take 0.1 to 0.2 s (autopilots assume 110 to 220 ms), links as much,
and one that comes each second, or is stamped when it comes, is half a second old."""
MISLED, LATER_SIGMA_S = 0.1, 2.0
"""How many receivers are off by as much as mistold places, or so late: facades reflect, an origin that a
phone has told is 5 m off (gps.gov), clocks of gateways are set by hand."""
HEIGHTS_OFF, HEIGHT_OFF_M = 0.2, 4.0
"""How many altimeters were not zeroed where their bearers set out, and what they are then off by: sensors are
good to half a hectopascal (data sheet of BMP390), and weather changes pressure by that in half an hour."""
HEIGHT_ZERO_M = 0.2
"""What one that was zeroed is off by: sensors repeat themselves to 3 Pa (data sheet of BMP390)."""
HEIGHT_WALK_M_PER_ROOT_S = 0.015
"""Weather, warmth and doors let what it is off by walk: by 0.4 m in ten minutes, 0.9 m in an hour."""
PRESSURE_SIGMA_M = 1.0
PRESSURE_CORRELATION_S = 30.0
"""Draught and doors move pressure for about so long: readings within it share their error."""
LAYER_SIGMA = 0.05
"""The air's mean temperature is known to about 5 %, and so is a height from pressure."""

RANGE_SIGMA_M: dict[str, float] = {"uwb": 0.3, "ultrasound": 0.05, "rtt": 1.3}
RANGE_SIGMA_OTHER_M = 0.5
RANGE_SCALE_SIGMA = 0.005
"""A clock is good to a few parts per million; what is left is calibration."""
OBSTRUCTED_SCALE = 0.1
"""By how much ranges are too long in all, where all are obstructed."""
RANGE_SCALE_WIDE = 0.15
"""Measured: a public UWB-like data set carries +7 % scale."""
UNCALIBRATED = 0.3
"""How many technologies have a scale of the wide kind."""
RANGE_BIAS_SIGMA_M: dict[str, float] = {"uwb": 0.15, "ultrasound": 0.05, "rtt": 1.5}
RANGE_BIAS_OTHER_SIGMA_M = 0.5
RADIO_BIAS = 0.2
"""How much of that is each radio's own, at one place: 3 cm of UWB's. Antenna delays of calibrated DW1000s are
good to some centimetres, and by the power received their ranges vary by as much (Decawave APS011)."""
MISTOLD, MISTOLD_SIGMA_M = 0.02, 4.0
"""How many told places are wrong, and how far along each axis: a corner or a door mistaken."""
DELAYED, DELAY_SIGMA_M = 0.02, 2.0
"""How many radios have an antenna delay that nobody has calibrated, and what it adds to their ranges: 10 ns
there and back are 1.5 m; offsets of Wi-Fi RTT chips differ by some metres."""
RANGE_NOISE = Mixture(outliers=0.1, shift=1.5, spread=3.0)
"""Obstructed ranges are too long: measured, Wi-Fi RTT's 95th percentile is at 4 to 6 m."""

RUNS_MPS, FLIES_MPS = 5.0, 20.0
"""Nobody inside gets away faster, and no UAV: what a range grows by beyond it is an echo."""
ECHOES = 0.999
"""How often a reading is one that follows such a jump."""
ECHO_UNHEARD_S, ECHO_LOWER_S = 3.0, 3.0
"""After so long a pause a jump tells nothing; and so long a level stays that is no glitch: hanyang has ranges
10 m too short for 0.3 s."""

RSSI_SIGMA_DB = 6.0
"""Measured: 5 to 7 dB."""
RSSI_POWER_DBM = -50.0
RSSI_POWER_SIGMA_DB = 10.0
"""At a metre: -40 dBm in paper A, -59 dBm of a usual BLE beacon."""
RSSI_EXPONENT = 2.2
RSSI_EXPONENT_SIGMA = 0.4
RSSI_EXPONENT_LEAST = 1.0
"""Along a corridor, which guides waves, powers fall by 12 to 18 dB a decade: measured, 14 at least."""
NEAR_M = 1.5
NEAR_SIGMA_DB = 4.5
"""Paper A: relative ranges within 1.5 m are accurate, in fire as well."""
ENCOUNTER_S = 3.0
ENCOUNTER_READINGS = 3
ENCOUNTER_M = 3.0
"""An estimate that puts both ends farther apart does not believe in an encounter."""
RSSI_NOISE = Mixture(outliers=0.05, shift=-8.0, spread=12.0)
"""A wall, a body or a fire takes away power; nothing adds much."""

BODIES = 0.5
"""How many radios are worn where bodies are seen in what they tell."""
NO_BODY_M, NO_BODY_DB = 0.02, 0.5
"""Of the others: an antenna is a centimetre or two nearer to one side, and sends a little more there."""
BODY_M: dict[str, float] = {"uwb": 0.3, "ultrasound": 0.1, "rtt": 0.5}
BODY_OTHER_M = 0.3
"""What a bearer's body makes a range longer by to what lies behind him, and shorter to what lies ahead,
against what lies beside him. Measured, a UWB tag at the chest errs by metres, at the forehead by 0.2 m (Otim
et al. 2019)."""
BODY_DB = 4.0
"""The same of powers: at 2.4 GHz a body takes 5 to 20 dB (Januszkiewicz 2018)."""
GOES_MPS = 0.3
"""Who is slower may turn where he stands: he is taken to face where he last went."""

FLOOR_M = 2.0
"""Between two radios inside that differ by more in height there is a floor."""
FLOOR_SIGMA = (3.0, 20.0)
"""What is added to the noise of a range (m) and of a signal (dB) through a floor. It takes 10 to 20 dB and
makes ranges half a metre too long. That is no noise: taken for it, many such readings would bend the map."""
WALL_M = 0.1
"""Between two radios inside there are walls, furniture and bodies: so much of a range's error stays while
nobody moves, however little readings that follow each other differ."""
EXCESS_M = (0.25, 0.5, 1.0)
"""What ranges through a light wall, several, or heavy ones are too long by: so much they scatter, too."""
EXCESS_COUNTS = (100.0, 2.0, 2.0, 2.0)
"""How many readings the usual shares count as, of links in sight first: most are, until readings tell."""
EXCESS_UNSURE = 0.5
"""By so much of it what ranges are too long by may differ from what they scatter by."""
OUTSIDE_ROLES = frozenset({"uav", "anchor"})

BEARING_SIGMA_RAD = 0.2
BEARING_NOISE = Mixture(outliers=0.1, shift=0.0, spread=1.0)
FIX_NOISE = Mixture(outliers=0.02, shift=0.0, spread=30.0)
HEIGHT_NOISE = Mixture(outliers=0.05, shift=0.0, spread=5.0)
TURN_NOISE = Mixture(outliers=0.1, shift=0.0, spread=radians(2.0))
STRAIGHT_NOISE = Mixture(outliers=0.2, shift=0.0, spread=radians(2.0))
"""Some corridors are round, and somebody walks round a tank."""
DROP_NOISE = Mixture(outliers=0.02, shift=0.0, spread=3.0)
NOISES = (
    RANGE_NOISE,
    RSSI_NOISE,
    BEARING_NOISE,
    BEARING_NOISE,
    FIX_NOISE,
    HEIGHT_NOISE,
    TURN_NOISE,
    STRAIGHT_NOISE,
    DROP_NOISE,
)
"""As the ledger numbers them: pairs by their kind (range, RSSI, bearing, bearing from a heading), then
others."""

SHARED_NOISE = 0.3
"""Share of a reading's variance that is the link's own until an end moves on, before it is learned."""
SHARED_M, PLACE_SHARED = 4.0, 0.5
"""A room's width: having walked it, one looks through other walls. And the share of what powers of a link
have in common that is its bearer's place's, for all that he hears there (3GPP TR 36.942, shadowing)."""
SHARED_S = 600.0
FREE_WAY_MPS = 0.5
NOISE_MEMORY = 300.0
"""How many readings back the noise of a technology is learned from."""
POWER_NOISE_MEMORY_S = 60.0
"""For how long at least powers tell it: what they scatter by is the place's, and a crew's radios measure so
many in some seconds."""
OUTLIER_PRIOR = 50.0
"""How many readings the usual share of outliers counts as."""
NOISE_PRIOR = 20.0
"""How many readings the assumed noise counts as."""

PENDING_S = 2.0
"""A reading waits so long for the displacement that covers its epoch, at least."""
REPORT_LATE, REPORT_LONGEST_S = 1.5, 20.0
"""Of a unit that reports seldom so many times what its newest report lasted; longer ones sum up a silence."""

# Static nodes that begin with ranges or RSSI only.
SIGHTINGS_MIN = 6
MODE_MARGIN = 7.0
"""How much worse (in log likelihood) the second mode must be: odds of 1 to 1,000."""
DECIDED_SIGMA_M: dict[str, float] = {"range": 2.0, "rssi": 4.0}
UNDECIDED_UP_SIGMA_M = 3.0
"""A node that only ranges tell of lies about as high as who measured it, or a storey off."""
UNDECIDED_MOVING_UP_SIGMA_M = 1.5
MOVING_SIGHTINGS_S = 3.0
SIGHTINGS_S = 900.0
UNSEEN_S = 10.0
"""Who moves and has been heard for so long is shown where he may be, decided or not: twice as long as a
velocity is remembered. What is older tells little of where he is."""
UNSEEN_SIGHTINGS_MIN = 4
"""So many readings of these seconds it takes: three tell a place, and one speaks against a wrong one."""
REACH_M = 100.0
"""Who hears a radio is so far from it, along each axis, for all that is known without what he hears: inside,
radios that locate reach some tens of metres, in the open a hundred and more."""
