"""What scripts/render draws, in ParaView."""
