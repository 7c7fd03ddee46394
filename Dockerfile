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
    && python -m estimator.warm \
    && useradd --create-home firethread && mkdir /data && chown firethread /data
USER firethread
VOLUME /data
EXPOSE 8000 7070
ENTRYPOINT ["firethread"]
