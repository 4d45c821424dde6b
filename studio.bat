@echo off
rem Start Kinetag Studio; the first time this makes its environment. Words after the name go to the studio:
rem   studio.bat record --source synthetic:walk --seconds 10 --library out
setlocal
call "%~dp0installers\environment.bat" run
if errorlevel 1 exit /b 1
"%KINETAG_PYTHON%" -m studio %*
exit /b %errorlevel%
