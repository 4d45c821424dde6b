"""What ``--help`` says below the options: what the words mean, and one example of each verb."""

import os

COMMAND = "studio.bat" if os.name == "nt" else "./studio.sh"
"""How the studio is started from its folder."""

TOP = f"""\
{COMMAND} without a verb opens the window. A first take, without any sensor:
  {COMMAND} record --source synthetic:walk --seconds 10 --library out --person P014
  {COMMAND} export TAKE --format bvh -o walk.bvh        TAKE is the folder that record printed
{COMMAND} VERB --help explains a verb. The manual is in resources/manual.
"""

DEVICES = f"""\
Each line begins with what --source of record takes.
example:
  {COMMAND} devices
"""

RECORD = f"""\
A SOURCE is one of
  synthetic[:SCRIPT][?tags=15&loss=0.05&seed=1&calibrated=1&speed=max]   a simulated performer
  serial:PORT[@BAUD]                                                     a receiver on a cable
  replay:TAKE[?speed=2]                                                  a take, played again
Begin with an N-pose of three seconds and a bow of two (resources/manual/poses.md).
example:
  {COMMAND} record --source serial:/dev/ttyACM0 --seconds 60 --library out --person P014 --stature 172
"""

IMPORT = f"""\
xio is a recording of x-IMU3 sensors: the folder that holds a folder for each sensor. csv is any table of
numbers; its map says what the columns are (resources/manual/import-tables.md). auto looks for itself.
example:
  {COMMAND} import left.csv right.csv --map legs.json --library out --person P014
"""

INSPECT = f"""\
example:
  {COMMAND} inspect out/P014/2026-11-24a/take-001_walk
"""

SOLVING = """\
attitude     how the orientation of each sensor is estimated: vqf from gyroscope and accelerometer, gyro from the
             gyroscope alone, device as the sensor itself says.
method       offline may look ahead; live gives what was seen while recording.
calibration  the correction of the gyroscopes: recorded with the take, latest known of each tag on this
             computer, or a file.
pose         when a pose was held, in seconds from the start of the take: n (N-pose), t (T-pose), bow, sit.
             Named poses replace all those of the take (resources/manual/poses.md).
"""

SOLVE = f"""\
{SOLVING}example:
  {COMMAND} solve out/P014/2026-11-24a/take-001_walk --pose n=2..5 --pose bow=8..10
"""

EXPORT = f"""\
formats      bvh is the moving skeleton; csv is a table: joints (angles in degrees), orientations (of each sensor),
             raw (what the sensors said).
presets      of bvh: blender in metres, motionbuilder in centimetres (also for iClone).
             of csv: plain with comma and decimal point; excel with semicolon, decimal comma and a byte order
             mark, as Excel in German, French, Italian and others opens by double click.
fps          of bvh only. native keeps the rate of the sensors. 23.976 and 29.97 are exactly 24000/1001 and 30000/1001.
overwrite    without it a file is replaced only if the studio wrote it from the same take and nobody changed it.
{SOLVING}example:
  {COMMAND} export out/P014/2026-11-24a/take-001_walk --format csv --table joints --preset excel -o walk.csv
"""
