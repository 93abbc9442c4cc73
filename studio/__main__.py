"""`python -m studio` is `a1-studio`."""

from studio.cli import main

if __name__ == "__main__":
    main()
