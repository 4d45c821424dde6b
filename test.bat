@echo off
rem Set everything up and run the checks: ruff, mypy, import-linter and the tests.
rem   test.bat                        all of it, without the long tests, the peers and the benchmarks
rem   test.bat --firmware             only the tests that compile the firmware; also --long, --peers, --benchmarks
rem   test.bat tests\core -k walk     only these tests: the words go to pytest
setlocal
set "KINETAG_MARKERS="
set "KINETAG_WORDS="

:words
if "%~1"=="" goto run
if "%~1"=="--firmware" (call :choose firmware) else if "%~1"=="--long" (call :choose long) else if "%~1"=="--peers" (call :choose peers) else if "%~1"=="--benchmarks" (call :choose benchmark) else set KINETAG_WORDS=%KINETAG_WORDS% %1
shift
goto words

:run
call "%~dp0installers\environment.bat" dev
if errorlevel 1 exit /b 1
where gcc >nul 2>&1
if errorlevel 1 (
    echo The tests compile C and gcc is missing: install MinGW-w64, put it on the PATH, then start again. 1>&2
    exit /b 1
)
cd /d "%~dp0"
set "KINETAG_FAILED="
if not "%KINETAG_MARKERS:peers=%"=="%KINETAG_MARKERS%" call :stage setting-up-the-peers "%KINETAG_PYTHON%" tests\peers\environments.py
if defined KINETAG_MARKERS (
    call :stage pytest "%KINETAG_PYTHON%" -m pytest -m "%KINETAG_MARKERS%" %KINETAG_WORDS%
) else if defined KINETAG_WORDS (
    call :stage pytest "%KINETAG_PYTHON%" -m pytest %KINETAG_WORDS%
) else (
    call :stage ruff "%KINETAG_PYTHON%" -m ruff check
    call :stage mypy "%KINETAG_PYTHON%" -m mypy
    call :stage import-linter "%KINETAG_VENV%\Scripts\lint-imports.exe" --no-logo
    rem Journeys run in real time: nothing else runs beside them.
    call :stage pytest "%KINETAG_PYTHON%" -m pytest -n auto --ignore=tests\journeys
    call :stage journeys "%KINETAG_PYTHON%" -m pytest tests\journeys
)
if not defined KINETAG_FAILED exit /b 0
echo Failed:%KINETAG_FAILED% 1>&2
exit /b 1

:choose
if defined KINETAG_MARKERS (set "KINETAG_MARKERS=%KINETAG_MARKERS% or %1") else set "KINETAG_MARKERS=%1"
exit /b 0

:stage
set "KINETAG_STAGE=%1"
echo == %KINETAG_STAGE% began %TIME% 1>&2
for /f "tokens=1,*" %%A in ("%*") do %%B
if errorlevel 1 (set "KINETAG_FAILED=%KINETAG_FAILED% %KINETAG_STAGE%") else echo == %KINETAG_STAGE%: passed 1>&2
echo == %KINETAG_STAGE% ended %TIME% 1>&2
exit /b 0
