"""Normal equations of a chain of keyframes with a border, and their elimination."""
