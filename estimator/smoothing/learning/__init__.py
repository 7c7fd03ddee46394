"""What a solution tells of units and technologies: their noise, their calibration, wrong steps."""
