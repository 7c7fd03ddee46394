"""What is kept between two ticks: of each node, of what has been fused, of what was before the window."""
