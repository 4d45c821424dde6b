"""Plots over time: signals of one sensor, joint angles of a take."""
