"""Targets that are one text: tables and MuJoCo."""
