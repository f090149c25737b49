"""Stribeck curves: friction along speed, load or roughness, with its minimum and its regimes."""
