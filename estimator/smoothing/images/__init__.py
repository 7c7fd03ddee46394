"""Who may be elsewhere: images of ways that readings do not tell apart, tried and told."""
