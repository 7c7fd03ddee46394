"""The screen as a commander sees it; a package, so that one browser serves all of it and nothing else."""
