"""What is known by now of units, radios and links: their noise, their calibration, what readings share."""
