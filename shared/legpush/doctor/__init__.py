"""`legpush doctor`: checks what this machine has for missions, films, pages and trainings."""
