#!/bin/sh
# Start Kinetag Studio; the first time this makes its environment. Words after the name go to the studio:
#   ./studio.sh record --source synthetic:walk --seconds 10 --library out
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
# shellcheck source=installers/environment.sh
. "$root/installers/environment.sh"

prepare run
[ $# -gt 0 ] || needs_window
exec "$venv/bin/python" -m studio "$@"
