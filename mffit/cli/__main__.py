from mffit.cli import main

main()
