"""What the whole-system tests share: hand-made peers, processes, captures."""
