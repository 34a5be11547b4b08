"""Jobs for the queues that studios have: chunks baked apart, then put together."""
