"""`legpush view`: a page in the browser that shows a live run or a recording.

Messages become the history of a run (`legpush.history.run_history`). A player decides which row of which episode is
shown, and scene, plots and panel show it. Nothing that users do on the page reaches the run.
"""
