"""`python -m equilux`."""

from equilux.cli import main

if __name__ == "__main__":
    main()
