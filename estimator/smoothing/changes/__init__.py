"""What is not as it was: nodes that lie elsewhere, links that have changed for good."""
