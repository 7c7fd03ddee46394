"""What leaves a solution: tracks, the measurements that hold a fix, what would make it surer."""
