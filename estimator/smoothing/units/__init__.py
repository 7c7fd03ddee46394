"""What a unit tells wrongly: it is worn the wrong way round, its frame has turned, it has seen no stairs."""
