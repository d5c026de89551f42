"""Files that people and tools read: tables, plots and pages."""
