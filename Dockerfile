# One image for the three processes; compose.yaml says which of them a container runs.
FROM python:3.11-slim-bookworm

# What MuJoCo renders with off screen: EGL without a GPU, and OSMesa.
RUN apt-get update \
    && apt-get install -y --no-install-recommends libegl1 libegl-mesa0 libgl1-mesa-dri libosmesa6 \
    && rm -rf /var/lib/apt/lists/*

ENV PYTHONUNBUFFERED=1 PIP_CONSTRAINT=/src/constraints.txt PIP_BUILD_CONSTRAINT=/src/constraints.txt

# Everything but legpush itself changes only when a pin does, so it has layers of its own; the large one is PyTorch.
WORKDIR /src
COPY constraints.txt ./
RUN pip install --no-cache-dir uv \
    && uv pip install --system --no-cache --torch-backend cpu -c constraints.txt torch
COPY pyproject.toml README.md LICENSE ./
COPY planner_proc planner_proc
COPY sim_proc sim_proc
COPY agent_proc agent_proc
COPY shared shared
COPY examples examples
RUN pip install --no-cache-dir ".[all]"

RUN useradd --create-home --uid 1000 legpush && install -d -o legpush -g legpush /runs
USER legpush
WORKDIR /
VOLUME /runs
CMD ["legpush", "--help"]
