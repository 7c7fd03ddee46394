# One image, two commands: `firethread serve --no-worker` and `firethread worker`.
FROM python:3.13-slim AS build
RUN apt-get update && apt-get install --yes --no-install-recommends make && rm -rf /var/lib/apt/lists/*
WORKDIR /src
COPY pyproject.toml requirements.txt requirements-dev.txt Makefile README.md ./
COPY backend backend
COPY estimator estimator
COPY migrations migrations
COPY frontend frontend
RUN make setup && .venv/bin/python -m hatchling build --target wheel

FROM python:3.13-slim
WORKDIR /srv
COPY requirements.txt ./
COPY --from=build /src/dist/*.whl ./
RUN pip install --no-cache-dir --require-hashes --requirement requirements.txt \
    && pip install --no-cache-dir --no-deps ./*.whl \
    && useradd --create-home firethread && mkdir /data /compiled && chown firethread /data /compiled
USER firethread
# Numba looks for what it has compiled where its user may write, which beside the sources is root only: who runs warms
# it, in a folder named to both. On another kind of processor it compiles anew, and keeps that here too.
ENV NUMBA_CACHE_DIR=/compiled
RUN python -m estimator.warm
VOLUME /data
EXPOSE 8000 7070
ENTRYPOINT ["firethread"]
