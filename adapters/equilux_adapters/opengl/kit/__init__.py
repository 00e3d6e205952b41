"""What stand-alone OpenGL scripts are made from, beside `equilux_adapters._triangles`: see there."""
