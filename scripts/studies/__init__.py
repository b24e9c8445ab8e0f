"""The studies of scripts/study.py."""
