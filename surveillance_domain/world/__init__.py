"""The worlds that cameras look at, and the simulated truth behind them."""
