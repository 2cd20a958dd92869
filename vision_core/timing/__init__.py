"""Timing: a rate keeper on a grid of periods, histograms of durations, rates of counters."""
