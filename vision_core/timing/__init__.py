"""How time is kept and counted: a grid of periods, histograms of durations, rates."""
