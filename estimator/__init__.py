"""Pure numerics of Firethread: no input or output, no clock, no logging, no global state."""
