"""What motion is: values and arithmetic, without Qt, files, threads or clocks."""
