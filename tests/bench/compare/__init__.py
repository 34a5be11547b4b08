"""What a frame costs in skinslide and in what a user would otherwise take, side by side. Run by tests/bench.sh."""
