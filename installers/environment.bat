@echo off
rem Called by studio.bat and test.bat: find Python, make the environment, install what pyproject.toml lists.
rem   environment.bat run|dev     leaves KINETAG_PYTHON behind
rem Everything said goes to stderr: stdout belongs to the verbs.
set "KINETAG_SUITABLE=import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))"
for %%D in ("%~dp0..") do if not defined KINETAG_VENV set "KINETAG_VENV=%%~fD\.venv"
set "KINETAG_PYTHON=%KINETAG_VENV%\Scripts\python.exe"
if exist "%KINETAG_PYTHON%" "%KINETAG_PYTHON%" -c "%KINETAG_SUITABLE%" >nul 2>&1 && goto install

set "KINETAG_BASE="
rem The store's own "python" only opens the store, so each candidate is run.
for %%P in ("py -3.13" "py -3.12" "py -3.11" "python3" "python") do call :try %%~P
if not defined KINETAG_BASE (
    echo Python 3.11, 3.12 or 3.13 is needed and none was found: install one from python.org, then start again. 1>&2
    exit /b 1
)
if exist "%KINETAG_VENV%" if not exist "%KINETAG_VENV%\pyvenv.cfg" (
    echo The folder %KINETAG_VENV% is in the way: move it, or name another with KINETAG_VENV. 1>&2
    exit /b 1
)
echo Making an environment in %KINETAG_VENV%. 1>&2
%KINETAG_BASE% -m venv --clear "%KINETAG_VENV%" 1>&2
if errorlevel 1 (
    echo The environment could not be made in %KINETAG_VENV% for the reason above. 1>&2
    exit /b 1
)

:install
"%KINETAG_PYTHON%" -I "%~dp0environment.py" %1 "%KINETAG_VENV%"
exit /b %errorlevel%

:try
if defined KINETAG_BASE exit /b 0
%* -c "%KINETAG_SUITABLE%" >nul 2>&1
if not errorlevel 1 set "KINETAG_BASE=%*"
exit /b 0
