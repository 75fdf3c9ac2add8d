"""What the solvers that choose step by step by simulation are made of: worlds, beliefs in them, returns to compare."""
