"""An incident shown again as it was."""
