"""Paper A's collaborative localization: its relative measurement graph, its noise models, its nodes."""
