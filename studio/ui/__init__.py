"""What a person sees. The only layer that may import Qt."""

import os

# Qt 6 splits each gradient over threads, 64 lines a piece. Limbs are small: waking and waiting cost four times the
# painting. Qt reads this at its first gradient; it can go when Qt splits large areas only.
os.environ.setdefault("QT_NO_GUI_THREADPOOL", "1")
