"""`legpush view`: a page in the browser that shows a live run or a recording.

Messages become timelines (`legpush.history.run_history`); a player says which row of which episode is looked at; scene,
plots and panel show that row. Nothing that is done here reaches the run.
"""
