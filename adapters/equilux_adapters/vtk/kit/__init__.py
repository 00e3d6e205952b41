"""What stand-alone VTK scripts are made from, beside `equilux_adapters._triangles`: see there."""
