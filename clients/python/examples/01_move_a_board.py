"""Five lines that move something: a board, or `trirrr device scenes/thesis.toml --listen tcp:127.0.0.1:7700`.

python 01_move_a_board.py tcp:127.0.0.1:7700
"""

import sys

from trirrr import Board

with Board.connect(sys.argv[1]) as board:
    board.enable()
    x, y, alpha = board.home()
    print("there:", board.move((x + 0.01, y, alpha + 0.05)))
    print("back:", board.move((x, y, alpha)))
