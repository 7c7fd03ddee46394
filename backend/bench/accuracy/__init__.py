"""How near every tracker comes to the truth, on the same readings; each concern is one file here."""
