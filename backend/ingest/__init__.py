"""A gateway's POST: limits, decoding, refusal by index, the durable answer."""
