"""Targets that are one text: Structured Text, tables, Modelica, MuJoCo."""
