"""The relative measurement graph of one incident: its Kirchhoff matrix, and the noise of its edges."""
